//! What the machine allows ([`sutura::study::limit`]), with the kernel's source beside this repository.

use sutura::study::limit::{Limit, SOURCE};

/// Median time of the limit for one millisecond of a lattice of `nx` × `ny` × `nz` nodes [µs of CPU], or `None` after saying what is missing.
#[must_use]
pub fn limit_us(nodes: [u32; 3]) -> Option<f64> {
    let measured = Limit::compile(&crate::root().join(SOURCE), nodes).and_then(|limit| limit.us());
    measured
        .map_err(|needs| crate::skipped("the yardstick", &needs.to_string()))
        .ok()
}
