//! Indenters on a half-space and on a layer with a rigid base: the assembled lattice at rest, solved in double precision, against
//! Boussinesq, Hertz, and Hayes et al. 1972.
//!
//! A unit force on one surface node moves the surface by U(i, j)/(E a), with U of no unit: a lattice has no length but its pitch a. One
//! solve gives U, and a smooth rigid indenter is then the sum of the forces of the nodes it touches. A quarter is solved: nodes of the
//! planes of symmetry keep to their plane, and the far sides and the bottom are put where they belong.
//!
//! Upright springs and diagonals join columns of the same parity of i + j only, and springs along x and y do not resist upright shear
//! between neighbours: under one node's force the nodes of its own parity sink about twice as far as the continuum, the others hardly.
//! Forces that favour no parity do not meet this.

use super::block::{PITCH, apart, linear, scene};
use super::reference::{M, V, conjugate_gradients};
use std::array::from_fn;
use std::f64::consts::PI;
use std::sync::LazyLock;
use sutura_controller::lattice::{Lattice, STEPS};
use sutura_controller::tissue;
use sutura_shared::scene::Law;

/// ν of the isotropic lattice.
const POISSON: f64 = 0.25;
const YOUNG: f64 = 100e3;
/// Array length of the largest quarter.
const LARGEST: usize = Lattice::<0>::guard([33; 3]) as usize;
/// Offsets from the load for which U is kept, in pitches.
const REACH: usize = 24;

/// U(i, j): how far a unit force at the origin pushes the surface in, times E a.
struct Influence([[f64; REACH]; REACH]);

impl Influence {
    fn between(&self, [ax, ay]: [i32; 2], [bx, by]: [i32; 2]) -> f64 {
        self.0[ax.abs_diff(bx) as usize][ay.abs_diff(by) as usize]
    }

    /// Under a unit force spread over both parities alike, by ¼, ½, ¼ along x and along y.
    fn under_a_point(&self, at: [i32; 2]) -> f64 {
        let nodes = (-1..=1).flat_map(|j: i32| (-1..=1).map(move |i: i32| [i, j]));
        let part = |node: [i32; 2]| f64::from((2 - node[0].abs()) * (2 - node[1].abs())) / 16.0;
        nodes.map(|node| part(node) * self.between(at, node)).sum()
    }
}

/// Of a half-space: its far boundary moves as Boussinesq's solution does, so it might be at any distance.
static HALF_SPACE: LazyLock<Influence> = LazyLock::new(|| influence([32; 3], boussinesq));

/// Displacement of a half-space at `place` from a unit force down at the origin, times E a; lengths in pitches, z up (Boussinesq).
fn boussinesq(place: V) -> V {
    let (depth, far) = (-place.z, place.norm());
    let outward = depth / far.powi(3) - (1.0 - 2.0 * POISSON) / (far * (far + depth));
    let down = depth * depth / far.powi(3) + 2.0 * (1.0 - POISSON) / far;
    V::new(place.x * outward, place.y * outward, -down) * ((1.0 + POISSON) / (2.0 * PI))
}

/// Where nothing moves.
fn held(_: V) -> V {
    V::zeros()
}

/// A quarter of `cells` voxels under a force at the corner where its planes of symmetry meet the surface; `boundary` displaces its
/// far sides and its bottom, times E a.
fn influence(cells: [u16; 3], boundary: impl Fn(V) -> V) -> Influence {
    let scene = scene(cells, Law::Isotropic, &[linear(YOUNG as f32)], &[]);
    let mut lattice: Box<Lattice<LARGEST>> = bytemuck::zeroed_box();
    tissue::assemble(&scene, &vec![1; scene.lattice.count()], &mut lattice).unwrap();
    let [nx, ny, nz] = lattice.nodes;
    let far = |[i, j, k]: [u32; 3]| i + 1 == nx || j + 1 == ny || k == 0;
    let free = |node: [u32; 3]| {
        let moves = [node[0] > 0, node[1] > 0, true].map(|moves| moves && !far(node));
        V::from(moves.map(|moves| f64::from(u8::from(moves))))
    };
    let scale = YOUNG * f64::from(PITCH);
    let given = |node: [u32; 3]| {
        let [x, y, z] = node.map(f64::from);
        let place = V::new(x, y, z + 1.0 - f64::from(nz));
        if far(node) { boundary(place) / scale } else { V::zeros() }
    };
    // Nodes that fill up a layer do not exist: they neither move nor bear.
    let everywhere = |value: &dyn Fn([u32; 3]) -> V| {
        let mut field = vec![V::zeros(); lattice.len()];
        lattice.nodes().for_each(|(node, n)| field[n] = value(node));
        field
    };
    let (free, given) = (everywhere(&free), everywhere(&given));
    let answer = |p: &[V]| {
        let mut product = product(&lattice, p);
        let parts = product.iter_mut().zip(&free);
        parts.for_each(|(q, free)| q.component_mul_assign(free));
        product
    };
    let mut load: Vec<V> = answer(&given).iter().map(|force| -force).collect();
    // The other three quarters carry the rest of the unit force.
    load[lattice.index([0, 0, nz - 1])].z -= 0.25;
    let moved = conjugate_gradients(&load, &vec![M::identity(); load.len()], 1e-18, answer);
    let down = |i: usize, j: usize| {
        if i >= nx as usize || j >= ny as usize {
            return f64::NAN;
        }
        let n = lattice.index([i as u32, j as u32, nz - 1]);
        -scale * (given[n] + moved[n]).z
    };
    Influence(from_fn(|i| from_fn(|j| down(i, j))))
}

/// What the springs, at rest, answer the displacements `p` with [N].
fn product(lattice: &Lattice<LARGEST>, p: &[V]) -> Vec<V> {
    let offsets = lattice.offsets();
    let along = STEPS.map(|step| V::from(step.map(f64::from)).normalize());
    let [stiffness, ..] = &lattice.stiffness;
    let mut product = vec![V::zeros(); p.len()];
    for low in 0..p.len() {
        for ((springs, offset), along) in stiffness.iter().zip(offsets).zip(&along) {
            let k = f64::from(springs[low]);
            if k > 0.0 {
                let pull = along * (k * along.dot(&(p[low + offset] - p[low])));
                product[low] -= pull;
                product[low + offset] += pull;
            }
        }
    }
    product
}

/// Surface nodes no further than `radius` from the origin, in pitches.
fn disc(radius: f64) -> Vec<[i32; 2]> {
    let n = radius.floor() as i32;
    let square = (-n..=n).flat_map(|j| (-n..=n).map(move |i| [i, j]));
    square.filter(|node| distance(*node) <= radius).collect()
}

fn distance([i, j]: [i32; 2]) -> f64 {
    f64::from(i).hypot(f64::from(j))
}

/// Force over E a² of a smooth rigid indenter whose surface would reach `depth` pitches down at each of `nodes`: Gauss–Seidel on the
/// nodes' forces, none of which may pull.
fn indent(influence: &Influence, nodes: &[[i32; 2]], depth: impl Fn(f64) -> f64) -> f64 {
    let mut force = vec![0.0; nodes.len()];
    let own = influence.between([0; 2], [0; 2]);
    for _ in 0..10_000 {
        let mut largest = 0.0_f64;
        for (n, node) in nodes.iter().enumerate() {
            let others = nodes.iter().zip(&force);
            let sunk: f64 = others.map(|(other, f)| influence.between(*node, *other) * f).sum();
            let next = (force[n] + (depth(distance(*node)) - sunk) / own).max(0.0);
            largest = largest.max((next - force[n]).abs());
            force[n] = next;
        }
        if largest < 1e-9 * force.iter().sum::<f64>() {
            return force.iter().sum();
        }
    }
    panic!("the forces under the indenter do not converge");
}

/// κ: how much stiffer than a half-space a layer bonded to a rigid base is under a flat punch of radius `aspect` times its thickness
/// (Lebedev & Ufliand 1958, Hayes et al. 1972).
///
/// Of the pressure's Hankel transform ∫ φ(t) cos ξt dt the surface's is L(ξh) times that of a half-space, and L the bonded layer's; the
/// condition under the punch becomes φ(x) − (2/π) ∫ φ(t) ∫ (1 − L(ξh)) cos ξt cos ξx dξ dt = 1 in units of the half-space's φ, and κ
/// is the mean of φ. As 0 < L < 1, repeating the sum converges.
fn layer_factor(aspect: f64) -> f64 {
    const POINTS: usize = 100;
    let k = 3.0 - 4.0 * POISSON;
    let missing = |x: f64| {
        let above = 2.0 * k * (2.0 * x).sinh() - 4.0 * x;
        1.0 - above / (2.0 * k * (2.0 * x).cosh() + 4.0 * x * x + 1.0 + k * k)
    };
    // 1 − L is below 1e-14 from ξh = 20 on.
    let waves = (0..400).map(|m| 0.05 * (f64::from(m) + 0.5));
    let step = aspect / POINTS as f64;
    let of_distance = |m: usize| -> f64 {
        let t = m as f64 * step;
        waves.clone().map(|x| missing(x) * (x * t).cos() * 0.05 / PI).sum()
    };
    let kernel: Vec<f64> = (0..2 * POINTS).map(of_distance).collect();
    let mut phi = vec![1.0; POINTS];
    for _ in 0..300 {
        let sum = |i: usize| -> f64 {
            let parts = phi.iter().enumerate();
            parts
                .map(|(j, phi)| phi * (kernel[i.abs_diff(j)] + kernel[i + j + 1]))
                .sum()
        };
        phi = (0..POINTS).map(|i| 1.0 + step * sum(i)).collect();
    }
    phi.iter().sum::<f64>() / POINTS as f64
}

/// Force over E a² of a flat punch on a half-space, 2 r δ/(1 − ν²), pushed in by one pitch.
fn on_half_space(radius: f64) -> f64 {
    2.0 * radius / (1.0 - POISSON * POISSON)
}

/// Radius of the circle whose area the nodes of a punch stand for, a² each.
fn radius_of(nodes: &[[i32; 2]]) -> f64 {
    (nodes.len() as f64 / PI).sqrt()
}

/// u = P (1 − ν²)/(π E r) at the surface, from three pitches on, along the axes and between them. Once of a half-space, once with the
/// far boundary held: what that takes falls off as 1/D with its distance, so 2 U(2D) − U(D) knows nothing of the solution, but
/// is good near the load only.
#[test]
fn a_point_force_moves_the_surface_as_boussinesq_says() {
    let [near, far] = [16, 32].map(|distance| influence([distance; 3], held).0);
    let limit = Influence(from_fn(|i| from_fn(|j| 2.0 * far[i][j] - near[i][j])));
    for (influence, reach) in [(&*HALF_SPACE, 16), (&limit, 5)] {
        for at in (3..=reach).flat_map(|r| [[r, 0], [r, r / 2], [r, r]]) {
            let measured = influence.under_a_point(at);
            let expected = (1.0 - POISSON * POISSON) / (PI * distance(at));
            eprintln!("{at:?}: {:.4} of Boussinesq", measured / expected);
            assert!(apart(measured, expected) < 0.05, "{at:?}: {measured} for {expected}");
        }
    }
}

/// A sphere of 2 mm pushed 0.5 mm into 100 kPa, F = 4/3 E/(1 − ν²) √R δ^1.5 = 71.1 mN: five to eight nodes in the contact's
/// radius √(Rδ) = 1 mm. In Hertz's theory a sphere is the paraboloid that osculates it.
#[test]
fn a_sphere_meets_the_force_of_hertz() {
    let (radius, depth) = (2e-3_f64, 0.5e-3_f64);
    let expected = 4.0 / 3.0 * YOUNG / (1.0 - POISSON * POISSON) * radius.sqrt() * depth.powf(1.5);
    assert!(apart(expected, 71.1e-3) < 1e-3, "{expected}");
    for nodes in [5.0, 6.0, 8.0] {
        let pitch = (radius * depth).sqrt() / nodes;
        let sphere = |r: f64| depth / pitch - 0.5 * r * r * pitch / radius;
        let force = indent(&HALF_SPACE, &disc(1.4 * nodes), sphere) * YOUNG * pitch * pitch;
        eprintln!("{nodes} nodes: {:.3} mN for {:.3} mN", 1e3 * force, 1e3 * expected);
        assert!(apart(force, expected) < 0.01, "{nodes}: {force} for {expected}");
    }
}

/// A flat punch of 2 mm pushed 0.5 mm into 100 kPa, F = 2 r E δ/(1 − ν²) = 213 mN. The pressure is infinite at the edge, which a
/// pitch blunts: the force falls short in proportion to the pitch, and two pitches extrapolate to none.
#[test]
fn a_flat_punch_meets_the_force_of_boussinesq() {
    let (radius, depth) = (2e-3, 0.5e-3);
    let expected = 2.0 * radius * YOUNG * depth / (1.0 - POISSON * POISSON);
    assert!(apart(expected, 213e-3) < 2e-3, "{expected}");
    let [coarse, fine] = [4.0, 8.0].map(|nodes| {
        let punch = disc(nodes);
        let ratio = indent(&HALF_SPACE, &punch, |_| 1.0) / on_half_space(radius_of(&punch));
        eprintln!(
            "{nodes} nodes: {:.1} mN for {:.1} mN",
            1e3 * ratio * expected,
            1e3 * expected
        );
        assert!((ratio - 1.0).abs() < 0.1, "{nodes}: {ratio}");
        ratio
    });
    let limit = 2.0 * fine - coarse;
    eprintln!("without a pitch: {:.1} mN", 1e3 * limit * expected);
    assert!((limit - 1.0).abs() < 0.01, "{limit}");
}

/// The same on a layer two radii and one radius thick.
#[test]
fn a_layer_on_a_rigid_base_is_stiffer_by_the_factor_of_hayes() {
    for thickness in [2, 1] {
        let [coarse, fine] = [4_u16, 8].map(|nodes| {
            let layers = nodes * thickness;
            // Beyond the punch what it does fades within a few thicknesses.
            let side = 2 * nodes + 3 * layers;
            let punch = disc(f64::from(nodes));
            let force = indent(&influence([side.min(40), side.min(40), layers], held), &punch, |_| 1.0);
            let radius = radius_of(&punch);
            let factor = layer_factor(radius / f64::from(layers));
            let measured = force / on_half_space(radius);
            eprintln!("{nodes} nodes on {layers} layers: {measured:.3} for {factor:.3}");
            assert!(apart(measured, factor) < 0.1, "{nodes}: {measured} for {factor}");
            measured / factor
        });
        let limit = 2.0 * fine - coarse;
        eprintln!("without a pitch: {limit:.4} of the factor");
        assert!((limit - 1.0).abs() < 0.01, "{limit}");
    }
}

/// κ tends to 1 where the layer is thick. Where it is thin, it is in uniaxial strain under the punch, F = π r² δ/h · E(1 − ν)/((1 + ν)(1 − 2ν)),
/// but for a rim as wide as it is thick: κ then grows by π (1 − ν)²/(2 (1 − 2ν)) for every thickness that the radius gains.
#[test]
fn the_layer_factor_has_its_limits() {
    assert!(apart(layer_factor(1e-3), 1.0) < 1e-3);
    let growth = layer_factor(4.0) - layer_factor(3.0);
    let expected = PI * (1.0 - POISSON).powi(2) / (2.0 * (1.0 - 2.0 * POISSON));
    eprintln!("factor grows by {growth:.4} for {expected:.4}");
    assert!(apart(growth, expected) < 0.01, "{growth} for {expected}");
}
