//! What the machine allows, in one table: `cargo bench -p sutura-tests --bench yardstick`.

use sutura_tests::yardstick::limit_us;

/// Lattices in nodes, x × y × z.
const SIZES: [[usize; 3]; 4] = [[8, 8, 4], [12, 12, 6], [16, 16, 8], [24, 24, 12]];

fn main() {
    println!("{:>10}  {:>6}  {:>10}", "lattice", "nodes", "limit [µs]");
    for [nx, ny, nz] in SIZES {
        let Some(limit) = limit_us(nx, ny, nz) else { return };
        println!("{:>10}  {:>6}  {limit:>10.1}", format!("{nx}x{ny}x{nz}"), nx * ny * nz);
    }
}
