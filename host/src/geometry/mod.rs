//! From surfaces to cells: reads triangle meshes, voxelizes them, and cuts the patch that the controller simulates.
//!
//! | module | what it gives |
//! |---|---|
//! | [`mesh`] | an indexed triangle surface and what is wrong with it |
//! | [`stl`] | a surface from an STL file, and back |
//! | [`units`] | the unit of length of a file |
//! | [`grid`] | a block of cubic cells in space |
//! | [`scanline`] | the signed crossings of the rows of a grid with a surface |
//! | [`winding`] | generalized winding numbers where a surface has holes |
//! | [`voxelize`] | which cells of a grid are inside a surface |
//! | [`lattice`] | nodes and springs of a set of cells |
//! | [`frame`] | the patch frame of a site on the skin |
//! | [`patch`] | the block of tissue around a wound |
//! | [`surface`] | the outer quads of a patch, for drawing |
//! | [`phantom`] | the built-in anatomy |
//!
//! Lengths are in millimetres unless a name says otherwise; everything is `f64`.

pub mod frame;
pub mod grid;
pub mod lattice;
pub mod mesh;
pub mod patch;
pub mod phantom;
pub mod scanline;
pub mod stl;
pub mod surface;
pub mod units;
pub mod voxelize;
pub mod winding;

/// A point or a direction in space [mm unless a name says otherwise].
pub type Vec3 = nalgebra::Vector3<f64>;
