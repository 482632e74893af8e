//! A layered block with a wound, as scenes make it.
#![allow(dead_code, reason = "each test binary uses its own part")]

use sutura_controller::lattice::{Lattice, PC_NODES, Tissue};
use sutura_controller::solver::Work;
use sutura_shared::scene::{
    Body, Contact, Device, Effect, Effects, Law, Output, Pose, Profile, Scene, Segment, Solver, Stitch, Tool, Wound,
};

pub const SKIN: f32 = 2e-3;

pub fn segments(breaks: &[f32], slopes_kpa: &[f32]) -> heapless::Vec<Segment, 5> {
    let pairs = std::iter::once(&0.0).chain(breaks).zip(slopes_kpa);
    pairs
        .map(|(b, s)| Segment {
            from_strain: *b,
            slope_pa: s * 1e3,
        })
        .collect()
}

/// Skin of 1.5 mm over muscle: the built-in scene's curves.
pub fn tissues(pitch: f32) -> heapless::Vec<sutura_shared::scene::Tissue, 4> {
    let mut tissues = heapless::Vec::new();
    let skin = Body::Soft {
        curve: segments(&[0.3, 0.6], &[281.0, 1700.0, 3660.0]),
        sheet: SKIN / pitch,
    };
    let muscle = Body::Soft {
        curve: segments(&[0.1, 0.2, 0.3, 0.4], &[26.0, 43.0, 70.0, 117.0, 190.0]),
        sheet: 1.0,
    };
    for (density_kg_m3, body) in [(1109.0, skin), (1090.0, muscle)] {
        tissues
            .push(sutura_shared::scene::Tissue { density_kg_m3, body })
            .unwrap();
    }
    tissues
}

/// A block of `cells` voxels, one layer of skin on top, with a wound of `gap` columns and `length` rows through all layers but two.
pub fn scene(cells: [u16; 3], pitch: f32, gap: u16, length: u16) -> (Scene, Vec<u8>) {
    let [cx, cy, cz] = cells;
    let left = (cx - gap) / 2;
    let first = (cy - length) / 2;
    let mut bytes = Vec::new();
    for k in 0..cz {
        for j in 0..cy {
            for i in 0..cx {
                let wound = gap > 0
                    && (left..left + gap).contains(&i)
                    && (first..first + length).contains(&j)
                    && f32::from(k) * pitch > 5.9e-3;
                bytes.push(if wound {
                    0
                } else if k + 1 == cz {
                    1
                } else {
                    2
                });
            }
        }
    }
    let half = |n: u16| -0.5 * f32::from(n) * pitch;
    let site = 0.5 * f32::from(gap) * pitch + 4e-3;
    let scene = Scene {
        effects: Effects::default()
            .with(Effect::Stiffening)
            .with(Effect::Puncture)
            .with(Effect::WoundContact)
            .with(Effect::SpringDamping),
        solver: Solver::BePcg {
            iterations: 10,
            newton: 1,
        },
        lattice: sutura_shared::scene::Lattice {
            cells,
            pitch_m: pitch,
            origin_m: [half(cx), half(cy), -f32::from(cz) * pitch],
            law: Law::Isotropic,
            damping_per_s: 20.0,
            spring_damping_s: 1e-3,
        },
        tissues: tissues(pitch),
        tool: Tool::Needle {
            radius_m: 0.026 / std::f32::consts::PI,
            length_m: 0.026,
        },
        contact: Contact {
            coupling_n_per_m: 800.0,
            coupling_n_s_per_m: 0.0,
            kernel_m: 3.5e-3,
        },
        stitch: Some(Stitch {
            left_m: [-site, 0.0],
            right_m: [site, 0.0],
            f0_n: [0.95, 0.665],
            under_m: 1.5e-3,
            friction_n_per_m: 0.0,
            cutting_n: 0.0,
        }),
        thread: None,
        wound: (gap > 0).then(|| Wound {
            faces: [left, left + gap],
            rows: [first + 1, first + length - 1],
            floor: 1 + (6e-3 / pitch).round() as u16,
            penalty_n_per_m: 2000.0,
        }),
        output: Output {
            scale: 1.0,
            slew_n: 0.5,
            passivity_n_s_per_m: 0.0,
        },
        device: Device {
            profile: Profile::Premium15,
            patch_from_device: Pose {
                position_m: [0.0; 3],
                quaternion: [1.0, 0.0, 0.0, 0.0],
            },
        },
        hand: None,
    };
    (scene, bytes)
}

pub fn memory() -> (Box<Lattice<PC_NODES>>, Box<Tissue<PC_NODES>>, Box<Work<PC_NODES>>) {
    (bytemuck::zeroed_box(), bytemuck::zeroed_box(), bytemuck::zeroed_box())
}

/// Voxels with a corner whose three edges span no positive volume.
pub fn inverted(lattice: &Lattice<PC_NODES>, tissue: &Tissue<PC_NODES>, cells: [u16; 3], bytes: &[u8]) -> usize {
    let [cx, cy, _] = cells.map(u32::from);
    let mut count = 0;
    for (n, _) in bytes.iter().enumerate().filter(|(_, b)| **b > 0) {
        let n = n as u32;
        let (i, j, k) = (n % cx, n / cx % cy, n / (cx * cy));
        let at = |x: u32, y: u32, z: u32| lattice.place(tissue, lattice.index([i + x, j + y, k + z]));
        let bad = (0..8_u32).any(|c| {
            let (x, y, z) = (c & 1, c >> 1 & 1, c >> 2);
            let o = at(x, y, z);
            let (ex, ey, ez) = (at(1 - x, y, z) - o, at(x, 1 - y, z) - o, at(x, y, 1 - z) - o);
            let sign = if (x + y + z) % 2 == 0 { 1.0 } else { -1.0 };
            ex.cross(&ey).dot(&ez) * sign <= 0.0
        });
        count += usize::from(bad);
    }
    count
}
