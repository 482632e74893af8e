//! What can be seen of a scene as it runs, for whoever records or draws it. Looking changes nothing.

use super::Controller;
use crate::math::Vec3;
use crate::needle::{Arc, Passage};
use crate::thread::Pull;
use crate::wound::{self, Edges};
use sutura_shared::scene::{STITCHES_MAX, Site};

impl<const N: usize> Controller<'_, N> {
    /// The tool as it stood in the last tick; `None` before the first.
    #[must_use]
    pub fn tool(&self) -> Option<Arc> {
        let (params, state) = self.running.as_ref()?;
        let needle = &state.needle;
        Some(Arc::new(params.needle.tool, needle.before?).shifted(needle.offset))
    }

    /// The puncture sites in the order in which a needle comes to them, and how far each is passed.
    pub fn sites(&self) -> impl Iterator<Item = (Site, &Passage)> {
        let needle = self.running.iter().map(|(_, state)| &state.needle);
        needle.flat_map(|needle| Site::ALL.into_iter().zip(&needle.sites))
    }

    /// Places [m] and velocities [m/s] of the thread's nodes, from the needle to the tail, patch frame.
    pub fn thread(&self) -> impl Iterator<Item = (Vec3, Vec3)> {
        let running = self.running.iter();
        running
            .filter_map(|(params, state)| Some(state.thread.as_ref()?.live(params.thread.as_ref()?)))
            .flatten()
    }

    /// Where the thread runs through the tissue, from the needle to the tail: the node on the needle's side, and the place [m].
    pub fn eyelets(&self) -> impl Iterator<Item = (usize, Vec3)> {
        let threads = self.running.iter().filter_map(|(_, state)| state.thread.as_ref());
        let eyelets = threads.flat_map(|thread| thread.course.through().iter().rev());
        eyelets.map(|eyelet| (eyelet.link, eyelet.place.point()))
    }

    /// The thread's pull in the last tick.
    #[must_use]
    pub fn pull(&self) -> Pull {
        self.running
            .as_ref()
            .map_or_else(Pull::default, |(_, state)| state.pull)
    }

    /// The wound's edges row by row, with the place along the wound [m], and at each stitch; none without a wound.
    #[must_use]
    pub fn wound(&self) -> Option<(impl Iterator<Item = (f32, Edges)>, [Edges; STITCHES_MAX])> {
        let (params, _) = self.running.as_ref()?;
        let faces = params.faces.as_ref()?;
        let (lattice, tissue) = (self.lattice(), self.tissue());
        Some((
            wound::edges(faces, lattice, tissue),
            wound::at_stitches(faces, lattice, tissue),
        ))
    }

    /// Force with which the thread draws the wound together at each stitch [N]: half the difference of what it does, across the wound, to the
    /// punctures left and right. Nothing before it runs through both.
    #[must_use]
    pub fn closing(&self) -> [f32; STITCHES_MAX] {
        let mut closing = [0.0; STITCHES_MAX];
        let Some(thread) = self.running.as_ref().and_then(|(_, state)| state.thread.as_ref()) else {
            return closing;
        };
        // From the tail on the thread runs through a and d of each stitch.
        let (pairs, _) = thread.load.as_chunks::<2>();
        for (closing, [left, right]) in closing.iter_mut().zip(pairs).take(thread.course.count.div_ceil(2)) {
            *closing = 0.5 * (left.x - right.x);
        }
        closing
    }

    /// How far the thread has cut through the tissue, at all punctures together [m]; effect `tearing`.
    #[must_use]
    pub fn torn(&self) -> f32 {
        self.running.as_ref().map_or(0.0, |(_, state)| state.sewn.torn)
    }
}
