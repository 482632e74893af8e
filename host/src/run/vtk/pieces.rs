//! One moment of each part as VTK data.

use nalgebra::{Matrix3, Vector3};
use sutura_controller::math::Vec3;
use sutura_shared::message::PunctureEvent;
use sutura_shared::scene::{Scene, Tool};
use vtkio::IOBuffer;
use vtkio::model::{
    Attribute, Attributes, CellType, Cells, DataSet, PolyDataPiece, UnstructuredGridPiece, VertexNumbers,
};

use crate::geometry::grid::Grid;
use crate::geometry::surface::surface;
use crate::run::watch::Frame;

/// Corners of a voxel in VTK's order for a hexahedron: around the bottom, then around the top.
const CORNERS: [[usize; 3]; 8] = [
    [0, 0, 0],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];
/// Pieces that a needle is drawn with.
const STROKES: usize = 48;

/// What does not change from frame to frame.
#[derive(Debug)]
pub(super) struct Topology {
    /// Every node at rest, x fastest [m].
    rest: Vec<Vec3>,
    /// Nodes of every voxel, in the order of [`CORNERS`].
    voxels: Vec<[usize; 8]>,
    /// Tissue of every voxel: 1 + its place in the scene.
    tissue: Vec<u8>,
    /// Edge of a voxel [m].
    pitch: f64,
    /// Nodes of the surface.
    shell: Vec<usize>,
    /// Its faces by those, counter-clockwise seen from outside, and the tissue of each.
    faces: Vec<([u32; 4], u8)>,
    tool: Tool,
}

impl Topology {
    /// The patch of a scene.
    pub(super) fn of(scene: &Scene, cells: &[u8]) -> Self {
        let lattice = &scene.lattice;
        let count = lattice.cells.map(usize::from);
        let [nx, ny, nz] = count.map(|cells| cells + 1);
        let filled = |[i, j, k]: [usize; 3]| cells[i + count[0] * (j + count[1] * k)];
        let all = (0..nz - 1).flat_map(|k| (0..ny - 1).flat_map(move |j| (0..nx - 1).map(move |i| [i, j, k])));
        let low: Vec<_> = all.filter(|cell| filled(*cell) != 0).collect();
        let corners = |[i, j, k]: [usize; 3]| CORNERS.map(|[a, b, c]| i + a + nx * (j + b + ny * (k + c)));
        let mut nodes: Vec<_> = low.iter().flat_map(|cell| corners(*cell)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let number = |node: usize| nodes.partition_point(|other| *other < node);
        let grid = Grid {
            origin: Vector3::from(lattice.origin_m).map(f64::from) * 1e3,
            pitch: f64::from(lattice.pitch_m) * 1e3,
            cells: count,
        };
        let shell = surface(cells, &grid, |_| true);
        let [x, y, z] = lattice.origin_m;
        let place = |node: &usize| {
            let [i, j, k] = [node % nx, node / nx % ny, node / (nx * ny)].map(|n| n as f32 * lattice.pitch_m);
            Vec3::new(x + i, y + j, z + k)
        };
        Self {
            rest: nodes.iter().map(place).collect(),
            voxels: low.iter().map(|cell| corners(*cell).map(number)).collect(),
            tissue: low.iter().map(|cell| filled(*cell)).collect(),
            pitch: f64::from(lattice.pitch_m),
            shell: shell.nodes.iter().map(|node| number(*node as usize)).collect(),
            faces: shell
                .quads
                .iter()
                .chain(&shell.cut_quads)
                .map(|quad| (quad.corners, quad.cell))
                .collect(),
            tool: scene.tool,
        }
    }

    /// The patch: a hexahedron for each voxel.
    pub(super) fn patch(&self, frame: &Frame) -> DataSet {
        let places: Vec<_> = self
            .rest
            .iter()
            .zip(&frame.displacement)
            .map(|(rest, by)| rest + by)
            .collect();
        let gradients: Vec<_> = self.voxels.iter().map(|voxel| self.gradient(voxel, &places)).collect();
        DataSet::inline(UnstructuredGridPiece {
            points: buffer(&places),
            cells: Cells {
                cell_verts: groups(self.voxels.iter().map(|voxel| voxel.map(|node| node as u64))),
                types: vec![CellType::Hexahedron; self.voxels.len()],
            },
            data: Attributes {
                point: vec![vectors("displacement_m", &frame.displacement)],
                cell: vec![
                    scalars("tissue", self.tissue.clone()),
                    scalars("strain", gradients.iter().map(strain).collect::<Vec<_>>()),
                    scalars(
                        "volume_ratio",
                        gradients.iter().map(|f| f.determinant() as f32).collect::<Vec<_>>(),
                    ),
                ],
            },
        })
    }

    /// Where the patch ends: a quad for each open face of a voxel.
    pub(super) fn surface(&self, frame: &Frame) -> DataSet {
        let by: Vec<_> = self.shell.iter().map(|node| frame.displacement[*node]).collect();
        let places: Vec<_> = self
            .shell
            .iter()
            .zip(&by)
            .map(|(node, by)| self.rest[*node] + by)
            .collect();
        let tissues: Vec<_> = self.faces.iter().map(|(_, tissue)| *tissue).collect();
        DataSet::inline(PolyDataPiece {
            points: buffer(&places),
            polys: Some(groups(self.faces.iter().map(|(corners, _)| corners.map(u64::from)))),
            data: Attributes {
                point: vec![vectors("displacement_m", &by)],
                cell: vec![scalars("tissue", tissues)],
            },
            ..PolyDataPiece::default()
        })
    }

    /// The tool: a needle as a line from its tip to its swage, a ball as its centre.
    pub(super) fn tool(&self, frame: &Frame) -> DataSet {
        let pose = &frame.tool;
        match self.tool {
            Tool::Ball { radius_m } => DataSet::inline(PolyDataPiece {
                verts: Some(groups([[0]])),
                ..points(&[pose.position], vec![scalars("radius_m", vec![radius_m])])
            }),
            Tool::Needle {
                radius_m,
                length_m,
                grasp_m,
            } => {
                let from_tip: Vec<_> = (0..=STROKES).map(|n| length_m * n as f32 / STROKES as f32).collect();
                let place = |from_tip: &f32| {
                    let angle = (length_m - grasp_m - from_tip) / radius_m;
                    pose.point(Vec3::new(angle.cos() - 1.0, angle.sin(), 0.0) * radius_m)
                };
                let places: Vec<_> = from_tip.iter().map(place).collect();
                line(&places, vec![scalars("from_tip_m", from_tip)])
            }
        }
    }

    /// Mean deformation gradient of a voxel: the mean of its four edges along each axis, over the pitch.
    fn gradient(&self, voxel: &[usize; 8], places: &[Vec3]) -> Matrix3<f64> {
        let along = |axis: usize| {
            let side = |(node, corner): (&usize, [usize; 3])| {
                places[*node].map(f64::from) * if corner[axis] == 1 { 1.0 } else { -1.0 }
            };
            voxel.iter().zip(CORNERS).map(side).sum::<Vector3<f64>>() / (4.0 * self.pitch)
        };
        Matrix3::from_columns(&[along(0), along(1), along(2)])
    }
}

/// Largest principal value of the Green strain ½ (Fᵀ F − 1).
fn strain(gradient: &Matrix3<f64>) -> f32 {
    let green = (gradient.transpose() * gradient - Matrix3::identity()) / 2.0;
    green.symmetric_eigenvalues().max() as f32
}

/// The thread from the needle to its tail; none where there is no thread.
pub(super) fn thread(frame: &Frame) -> Option<DataSet> {
    let (places, velocities): (Vec<_>, Vec<_>) = frame.thread.iter().copied().unzip();
    let tension = vec![frame.tension_n; places.len()];
    let data = vec![
        vectors("velocity_m_per_s", &velocities),
        scalars("needle_tension_n", tension),
    ];
    (!places.is_empty()).then(|| line(&places, data))
}

/// The sites that have been punctured, with the forces at which they gave way; none before the first.
pub(super) fn punctures(frame: &Frame, punctures: &[PunctureEvent]) -> Option<DataSet> {
    let last = |site| punctures.iter().rev().find(|puncture| puncture.site == site);
    let made: Vec<_> = frame
        .sites
        .iter()
        .filter_map(|(site, place)| Some((last(*site)?, *place)))
        .collect();
    let places: Vec<_> = made.iter().map(|(_, place)| *place).collect();
    let of = |value: fn(&PunctureEvent) -> f32| made.iter().map(|(puncture, _)| value(puncture)).collect::<Vec<_>>();
    let sites: Vec<_> = made.iter().map(|(puncture, _)| puncture.site as u8).collect();
    let data = vec![
        scalars("site", sites),
        scalars("force_n", of(|puncture| puncture.force_n)),
        scalars("f0_n", of(|puncture| puncture.f0_n)),
        scalars("time_s", of(|puncture| puncture.tick as f32 * 1e-3)),
    ];
    (!places.is_empty()).then(|| {
        DataSet::inline(PolyDataPiece {
            verts: Some(groups((0..places.len() as u64).map(|point| [point]))),
            ..points(&places, data)
        })
    })
}

fn line(places: &[Vec3], data: Vec<Attribute>) -> DataSet {
    DataSet::inline(PolyDataPiece {
        lines: Some(VertexNumbers::XML {
            connectivity: (0..places.len() as u64).collect(),
            offsets: vec![places.len() as u64],
        }),
        ..points(places, data)
    })
}

fn points(places: &[Vec3], data: Vec<Attribute>) -> PolyDataPiece {
    PolyDataPiece {
        points: buffer(places),
        data: Attributes {
            point: data,
            cell: Vec::new(),
        },
        ..PolyDataPiece::default()
    }
}

/// Cells of `M` points each.
fn groups<const M: usize>(cells: impl IntoIterator<Item = [u64; M]>) -> VertexNumbers {
    let connectivity: Vec<_> = cells.into_iter().flatten().collect();
    VertexNumbers::XML {
        offsets: (1..=connectivity.len() / M).map(|cell| (cell * M) as u64).collect(),
        connectivity,
    }
}

fn buffer(vectors: &[Vec3]) -> IOBuffer {
    IOBuffer::F32(vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect())
}

fn vectors(name: &str, vectors: &[Vec3]) -> Attribute {
    Attribute::vectors(name).with_data(buffer(vectors))
}

fn scalars(name: &str, values: impl Into<IOBuffer>) -> Attribute {
    Attribute::scalars(name, 1).with_data(values)
}
