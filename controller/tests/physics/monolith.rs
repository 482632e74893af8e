//! Thread and tissue condensed onto each other against both solved at once: all nodes of a patch and of a thread in one system,
//! double precision, Newton's method until nothing moves.

use super::block::{Block, DEFAULT, PITCH, linear, scene};
use super::reference::{DT, M, Springs, Tie, V, add_ties, conjugate_gradients, dot, tangent};
use sutura_controller::coupling::{Coupling, Kernel, TAIL};
use sutura_controller::math::Vec3;
use sutura_controller::solver::predict;
use sutura_controller::surface::kernel_at;
use sutura_controller::thread::{self, Ends, Ground, Touch};
use sutura_shared::scene::{self, Effects, Law};

/// Skin on three layers of muscle: Young's moduli of their first slopes [Pa].
const SKIN: f32 = 281e3;
const MUSCLE: f32 = 26e3;
const CELLS: [u16; 3] = [8, 7, 4];
/// Mass damping of the tissue [1/s].
const DAMPING: f32 = 50.0;
/// Spring between N₀ and the swage [N/m].
const COUPLING: f32 = 800.0;
const THREAD: scene::Thread = scene::Thread {
    nodes: 11,
    link_m: 5e-3,
    axial_n: 76.0,
    mass_kg_per_m: 43e-6,
    damping_per_s: 20.0,
    penalty_n_per_m: 1000.0,
    friction: 0.0,
    knot_hold_n: 0.0,
    bending_n_m2: 0.0,
};
/// What the controller tells the thread's own iterations of the skin [N/m].
const END_STIFFNESS: f32 = 300.0;
const LINKS: usize = THREAD.nodes as usize - 1;

/// Where the swage is after `tick` ticks at 1 m/s, `slack` before the thread is taut at first [m].
fn swage(slack: f32, tick: u16) -> Vec3 {
    Vec3::new(0.6, 0.0, 0.8) * (params().length() - slack + 1e-3 * f32::from(tick))
}

/// Skin over muscle, held at its sides and its bottom.
fn patch() -> Block {
    let mut scene = scene(CELLS, Law::Isotropic, &[linear(SKIN), linear(MUSCLE)], &[]);
    scene.lattice.damping_per_s = DAMPING;
    let [x, y, z] = CELLS.map(usize::from);
    let layer = |n: usize| if n / (x * y) + 1 == z { 1 } else { 2 };
    Block::new(&scene, &(0..x * y * z).map(layer).collect::<Vec<_>>())
}

/// The tail is tied to the middle of the skin, where the patch has its origin.
fn tail(block: &Block) -> Kernel {
    kernel_at(&block.lattice, &block.tissue, Vec3::zeros(), 1.75 * PITCH)
}

/// Nothing for the thread to lie on.
struct Air;

impl Ground for Air {
    fn at(&self, _: Vec3) -> Option<Touch> {
        None
    }
}

fn params() -> thread::Params {
    thread::build(&THREAD, COUPLING, Effects(0)).unwrap()
}

fn laid(slack: f32) -> thread::State {
    thread::State::laid(&params(), swage(slack, 0), Vec3::zeros(), Vec3::y())
}

/// Force on the needle in every tick [N], as the controller computes it.
fn condensed(slack: f32, ticks: u16) -> Vec<V> {
    let mut block = patch();
    let (params, mut state, mut work) = (params(), laid(slack), thread::Work::default());
    let kernel = tail(&block);
    let mut tick = |tick| {
        let mut coupling = Coupling::default();
        coupling.kernels[TAIL] = kernel;
        let predicted = kernel.gather(&block.tissue.displacement) + predict(&coupling, &block.tissue)[TAIL];
        let ends = Ends {
            swage: Some(swage(slack, tick)),
            tail: Some(predicted),
            end_stiffness: END_STIFFNESS,
            ..Ends::default()
        };
        let condensed = thread::condense(&params, &state, &ends, &Air, &mut work);
        coupling.force[TAIL] = condensed.force[0];
        coupling.stiffness[TAIL][TAIL] = condensed.stiffness[0][0];
        let moved = block.tick(DEFAULT, &coupling, None);
        let pull = thread::settle(&params, &mut state, &mut work, &moved);
        pull.on_needle.map(f64::from)
    };
    (1..=ticks).map(&mut tick).collect()
}

/// Displacements of the tissue's nodes, then places of N₀ to N₍ₙ₋₂₎; the tail N₍ₙ₋₁₎ is the kernel's mean of the former.
struct Monolith {
    tissue: Springs,
    kernel: Vec<(usize, f64)>,
    /// m (1 + α dt)/dt² [N/m].
    inertia: Vec<f64>,
    /// dt/(1 + α dt) [s].
    coast: Vec<f64>,
    place: Vec<V>,
    velocity: Vec<V>,
}

impl Monolith {
    fn new(slack: f32) -> Self {
        let block = patch();
        let top = usize::from(CELLS[2]) - 1;
        let young = |layer: usize| f64::from(if layer == top { SKIN } else { MUSCLE });
        let tissue = Springs::layered(&block, Law::Isotropic, young);
        let mut place = vec![V::zeros(); tissue.mass.len()];
        let nodes = laid(slack).nodes;
        place.extend(nodes.iter().take(LINKS).map(|node| node.point().map(f64::from)));
        let link = f64::from(THREAD.mass_kg_per_m) * f64::from(THREAD.link_m);
        let skin = tissue.mass.iter().map(|m| (*m, f64::from(DAMPING)));
        let thread = (0..LINKS).map(|i| (if i == 0 { 0.5 * link } else { link }, f64::from(THREAD.damping_per_s)));
        let (inertia, coast) = skin
            .chain(thread)
            .map(|(m, alpha)| (m * (1.0 + alpha * DT) / (DT * DT), DT / (1.0 + alpha * DT)))
            .unzip();
        Self {
            kernel: tail(&block).iter().map(|(node, w)| (node, f64::from(w))).collect(),
            velocity: vec![V::zeros(); place.len()],
            tissue,
            inertia,
            coast,
            place,
        }
    }

    /// Index of N₀.
    fn first(&self) -> usize {
        self.tissue.mass.len()
    }

    /// The same vectors with the tail's after them.
    fn with_tail(&self, of: &[V]) -> Vec<V> {
        let tail = self.kernel.iter().map(|(node, w)| of[*node] * *w).sum();
        of.iter().copied().chain([tail]).collect()
    }

    /// What acts on the tail acts on the kernel's nodes; held nodes bear what acts on them.
    fn without_tail(&self, mut of: Vec<V>) -> Vec<V> {
        let tail = of.pop().unwrap();
        self.kernel.iter().for_each(|(node, w)| of[*node] += tail * *w);
        self.tissue.clear_held(&mut of);
        of
    }

    /// Both ends of every taut link, the way between them, T and EA/l₀.
    fn taut(&self, place: &[V]) -> impl Iterator<Item = ([usize; 2], V, f64, f64)> {
        let (rest, axial) = (f64::from(THREAD.link_m), f64::from(THREAD.axial_n));
        let all = self.with_tail(place);
        let links = (self.first()..)
            .take(LINKS)
            .map(move |a| ([a, a + 1], all[a + 1] - all[a]));
        links
            .filter(move |(_, d)| d.norm() > rest)
            .map(move |(ends, d)| (ends, d, axial * (d.norm() / rest - 1.0), axial / rest))
    }

    fn residual(&self, place: &[V], swage: V) -> Vec<V> {
        let mut force = self.tissue.force(&place[..self.first()]);
        force.resize(place.len() + 1, V::zeros());
        for ([a, b], d, tension, _) in self.taut(place) {
            let pull = d.normalize() * tension;
            force[a] += pull;
            force[b] -= pull;
        }
        force[self.first()] += (swage - place[self.first()]) * f64::from(COUPLING);
        let then = self
            .place
            .iter()
            .zip(&self.velocity)
            .zip(self.inertia.iter().zip(&self.coast));
        for ((f, x), ((before, v), (inertia, coast))) in force.iter_mut().zip(place).zip(then) {
            *f += (v * *coast - (x - before)) * *inertia;
        }
        self.without_tail(force)
    }

    /// Newton's step; every tangent is positive semidefinite.
    fn step(&self, place: &[V], residual: &[V]) -> Vec<V> {
        let mut ties: Vec<Tie> = self.tissue.tangents(&place[..self.first()]);
        ties.extend(
            self.taut(place)
                .map(|(ends, d, tension, k)| (ends, tangent(d, k, tension / d.norm()))),
        );
        let mut own: Vec<M> = self.inertia.iter().map(|i| M::identity() * *i).collect();
        own[self.first()] += M::identity() * f64::from(COUPLING);
        let mut blocks = own.clone();
        for (node, block) in ties.iter().flat_map(|(ends, block)| ends.map(|end| (end, block))) {
            if let Some(sum) = blocks.get_mut(node) {
                *sum += block;
            }
        }
        // Nodes of the box that do not exist have no block, nor a residual.
        let inverse: Vec<M> = blocks
            .iter()
            .map(|block| block.try_inverse().unwrap_or_default())
            .collect();
        conjugate_gradients(residual, &inverse, 1e-14, |p| {
            let mut product: Vec<V> = own.iter().zip(p).map(|(own, p)| own * p).collect();
            product.push(V::zeros());
            add_ties(&ties, &self.with_tail(p), &mut product);
            self.without_tail(product)
        })
    }

    /// One backward Euler step; force on the needle [N]. A step is halved while it overshoots: links become taut and slack on the way.
    fn tick(&mut self, swage: V) -> V {
        let mut place: Vec<V> = self.place.iter().zip(&self.velocity).map(|(x, v)| x + v * DT).collect();
        for _ in 0..200 {
            let residual = self.residual(&place, swage);
            let step = self.step(&place, &residual);
            let slope = dot(&step, &residual);
            let mut part = 1.0;
            let next = loop {
                let next: Vec<V> = place.iter().zip(&step).map(|(x, s)| x + s * part).collect();
                if part < 1e-3 || dot(&step, &self.residual(&next, swage)) > -0.5 * slope {
                    break next;
                }
                part *= 0.5;
            };
            place = next;
            if step.iter().all(|s| s.norm() < 1e-11) {
                let moved = place.iter().zip(&self.place);
                self.velocity = moved.map(|(x, before)| (x - before) / DT).collect();
                self.place = place;
                return (self.place[self.first()] - swage) * f64::from(COUPLING);
            }
        }
        panic!("the reference does not converge");
    }
}

/// The thread goes taut at 1 m/s, at one moment of a tick or another, and is drawn 10 mm further: within 1 % of the peak in every tick.
#[test]
fn the_coupling_force_is_that_of_one_system_while_the_thread_goes_taut() {
    for slack in [3e-3, 3.25e-3, 3.5e-3, 3.75e-3] {
        let ticks = 13;
        let mut reference = Monolith::new(slack);
        let exact: Vec<V> = (1..=ticks)
            .map(|tick| reference.tick(swage(slack, tick).map(f64::from)))
            .collect();
        let peak = exact.iter().map(V::norm).fold(0.0, f64::max);
        let forces = condensed(slack, ticks);
        let errors = forces.iter().zip(&exact).map(|(force, exact)| (force - exact).norm());
        let error = errors.fold(0.0, f64::max);
        eprintln!(
            "taut after {:.2} mm: {error:.1e} N apart, {:.2} % of {peak:.2} N",
            1e3 * slack,
            100.0 * error / peak
        );
        assert!(peak > 3.0 && error < 0.01 * peak, "{error} of {peak} N");
    }
}
