//! Every size on the wire. One frame is what a line is blocked by: 2.6 ms at 921,600 baud.

/// Longest payload of a frame: one scene chunk.
pub const PAYLOAD_MAX: usize = 232;
/// Kind, session and sequence number.
pub const HEADER: usize = 4;
/// CRC-32C.
pub const CRC: usize = 4;
/// Longest frame before byte stuffing.
pub const BODY_MAX: usize = HEADER + PAYLOAD_MAX + CRC;
/// The same stuffed: one byte more, as long as it is at most 254.
pub const STUFFED_MAX: usize = BODY_MAX + 1;
/// The same between its two delimiters.
pub const WIRE_MAX: usize = STUFFED_MAX + 2;
/// Longest stretch of a scene in one chunk.
pub const CHUNK_MAX: usize = 224;
/// Longest `postcard(Scene)`.
pub const SCENE_MAX: usize = 4096;
/// Most cells of a lattice.
pub const CELLS_MAX: usize = 8192;
/// What the controller must hold of an upload before it may look at it.
pub const STAGING_MAX: usize = SCENE_MAX + CELLS_MAX;
/// Most nodes of a thread.
pub const THREAD_NODES_MAX: u16 = 1024;
/// Longest detail of a refusal, in bytes of UTF-8.
pub const DETAIL_MAX: usize = 64;

const _: () = assert!(BODY_MAX <= 254, "a longer body is stuffed with more than one byte");
// Transfer, offset and length as varints that fit the largest staging.
const _: () = assert!(CHUNK_MAX + 1 + 3 + 2 <= PAYLOAD_MAX && STAGING_MAX < 1 << 21 && CHUNK_MAX < 1 << 14);
const _: () = assert!(DETAIL_MAX + 16 <= PAYLOAD_MAX);
