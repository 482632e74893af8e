//! What is seen of a run: energy, force and finiteness at every tick, and the tissue at its end.
//!
//! Energy is kinetic and elastic, in double precision by the model of [`crate::study::double`]: zero at rest.

use sutura_controller::lattice::{Lattice, PC_NODES, Tissue};
use sutura_controller::math::{DT, Vec3};
use sutura_controller::record::Output;
use sutura_controller::safety;
use sutura_shared::scene::Scene;

use super::inverted::inverted;
use crate::study::block::{Block, Error};
use crate::study::double::{Field, Model};

/// One tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Energy above the undisturbed rest [J].
    pub energy_j: f64,
    /// What the device is told [N].
    pub rendered_n: f64,
    /// Its change since the tick before [N].
    pub change_n: f64,
    /// The most that it may change by [N].
    pub may_change_n: f64,
    /// Whether all state is finite and the controller has found no fault.
    pub finite: bool,
}

/// All that a run is judged by.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Tick by tick.
    pub moments: Vec<Moment>,
    /// How many moments there were when the input stopped; the next is the state it left, before any tick.
    pub input: usize,
    /// The most that the device may be told [N].
    pub largest_n: f64,
    /// Largest displacement of any node at the end [m].
    pub displacement_m: f64,
    /// Inverted voxels at the end.
    pub inverted: usize,
    /// Energy that counts as its peak at least, from before the input stopped [J].
    pub peak_j: f64,
    /// What the hand felt, where there is one.
    pub felt: Option<Felt>,
}

/// What a hand on the device felt.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Felt {
    /// Least energy that the rendering had absorbed at any time, by the force really sent and the tip's real way [J]; below zero it gave.
    pub least_j: f64,
    /// Root mean square of the force above 20 Hz over a second of holding still or trembling, the worst [N].
    pub buzz_n: f64,
}

/// A watch over one run.
#[derive(Clone, Debug)]
pub struct Watch {
    model: Model,
    cells: Vec<u8>,
    edge: safety::Params,
    moments: Vec<Moment>,
    input: usize,
    rendered: Vec3,
    /// The tip and its last way [m].
    tip: Option<Vec3>,
    way: f32,
    at: Field,
    force: Field,
}

impl Watch {
    /// Over a run of this scene.
    ///
    /// # Errors
    /// The lattice cannot be assembled.
    pub fn new(scene: &Scene, cells: &[u8]) -> Result<Self, Error> {
        let Block { lattice, material } = Block::of(scene, cells)?;
        let model = Model::new(&lattice, &material);
        let zeros = Field::zeros(model.len());
        Ok(Self {
            model,
            cells: cells.to_vec(),
            edge: safety::Params::new(&scene.output, scene.device.profile, scene.effects),
            moments: Vec::new(),
            input: 0,
            rendered: Vec3::zeros(),
            tip: None,
            way: 0.0,
            at: zeros.clone(),
            force: zeros,
        })
    }

    /// Sees a tick: the tissue at its end, the controller's answer, and what energy is held elsewhere, in the tool's coupling or a thread [J].
    pub fn see(
        &mut self,
        (lattice, tissue): (&Lattice<PC_NODES>, &Tissue<PC_NODES>),
        output: &Output,
        elsewhere_j: f64,
    ) {
        let energy_j = self.energy(lattice, tissue) + elsewhere_j;
        let rendered = output.rendered.get();
        // Passivity damping comes after the slew and ends with its tick, so it may come and go on top.
        let way = self.tip.map_or(0.0, |before| (output.position - before).norm());
        let damped = self.edge.damping.unwrap_or(0.0) * (way + self.way) / DT;
        (self.tip, self.way) = (Some(output.position), way);
        self.moments.push(Moment {
            energy_j,
            rendered_n: f64::from(rendered.norm()),
            change_n: f64::from((rendered - self.rendered).norm()),
            // Zero force at a fault is exempt.
            may_change_n: match output.faults.none() {
                true => f64::from(self.edge.slew + damped),
                false => f64::INFINITY,
            },
            finite: output.faults.none() && energy_j.is_finite(),
        });
        self.rendered = rendered;
    }

    /// The input stops here: what follows is the tissue's own. The state it leaves, with what energy is held elsewhere [J], is a moment of its own.
    pub fn let_go(&mut self, (lattice, tissue): (&Lattice<PC_NODES>, &Tissue<PC_NODES>), elsewhere_j: f64) {
        self.input = self.moments.len();
        let energy_j = self.energy(lattice, tissue) + elsewhere_j;
        let rendered_n = f64::from(self.rendered.norm());
        self.moments.push(Moment {
            energy_j,
            rendered_n,
            change_n: 0.0,
            may_change_n: f64::INFINITY,
            finite: energy_j.is_finite(),
        });
    }

    /// The run is over.
    #[must_use]
    pub fn trace(self, lattice: &Lattice<PC_NODES>, tissue: &Tissue<PC_NODES>) -> Trace {
        let exists = |n: &usize| lattice.mass.get(*n).is_some_and(|mass| *mass > 0.0);
        let far = |n: usize| f64::from(sutura_controller::lattice::at(&tissue.displacement, n).norm());
        let farthest = |most: f64, far: f64| if far.is_nan() { f64::INFINITY } else { most.max(far) };
        Trace {
            displacement_m: (0..lattice.len()).filter(exists).map(far).fold(0.0, farthest),
            inverted: inverted(lattice, tissue, &self.cells),
            moments: self.moments,
            input: self.input,
            peak_j: 0.0,
            felt: None,
            largest_n: f64::from(self.edge.max),
        }
    }

    /// Kinetic and elastic energy [J].
    fn energy(&mut self, lattice: &Lattice<PC_NODES>, tissue: &Tissue<PC_NODES>) -> f64 {
        for (wide, narrow) in self.at.parts.iter_mut().zip(&tissue.displacement) {
            wide.iter_mut()
                .zip(narrow)
                .for_each(|(wide, narrow)| *wide = f64::from(*narrow));
        }
        let elastic = self.model.elastic(&self.at, &mut self.force);
        let n = self.model.len();
        let moving = |velocity: &[f32; PC_NODES]| -> f64 {
            let nodes = velocity.iter().zip(&lattice.mass).zip(&lattice.free).take(n);
            let squares = nodes.map(|((v, m), free)| f64::from(*free) * f64::from(*m) * f64::from(*v).powi(2));
            squares.sum()
        };
        elastic + 0.5 * tissue.velocity.iter().map(moving).sum::<f64>()
    }
}
