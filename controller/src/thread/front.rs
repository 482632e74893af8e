//! Forward elimination of the nodes, from N₀ to the tail, onto the points that hold the thread.
//!
//! With u the nodes' displacements and c those of the points, −∂²/∂(u, c)² of the incremental energy is block-tridiagonal in u, or where
//! the thread bends block-pentadiagonal; the link in an eyelet has a part for each of its points besides. Behind it every node is tied to
//! all the eyelets passed, but only through the last piece of that link: it pulls along one line, as its length and that of the other
//! pieces have it, and turns about its own eyelet. So the blocks of node and eyelets are U X_j with one U, and the elimination carries
//! one column, U's, for the vector y = Σ X_j c_j however many the eyelets are, and gathers them where the thread passes the next one.

use core::ops::Range;

use super::bend::Joint;
use super::chain::{CORNERS, Forces};
use super::factor::Factor;
use super::link::Link;
use crate::coupling::{POINTS, PUNCTURES, TAIL};
use crate::math::{Mat3, Vec3};

/// The thread as the tissue sees it: its force at displacements c of the points from their predicted positions is
/// `force − stiffness·c`. A point that does not hold the thread has zeros.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condensed {
    /// Force on each point [N]: the tail's, then the eyelets' in their order.
    pub force: [Vec3; POINTS],
    /// Stiffness, symmetric and positive semidefinite [N/m].
    pub stiffness: [[Mat3; POINTS]; POINTS],
    /// Points that there are; the others have zeros.
    pub len: usize,
}

impl Default for Condensed {
    fn default() -> Self {
        Self {
            force: [Vec3::zeros(); POINTS],
            stiffness: [[Mat3::zeros(); POINTS]; POINTS],
            len: 1,
        }
    }
}

impl Condensed {
    /// The forces at displacements `c`.
    pub(super) fn at(&self, c: &[Vec3; POINTS]) -> [Vec3; POINTS] {
        let mut force = self.force;
        for (force, row) in force.iter_mut().zip(&self.stiffness).take(self.len) {
            for (block, c) in row.iter().zip(c).take(self.len) {
                *force -= block * c;
            }
        }
        force
    }

    /// Takes the mean of the two halves, which rounding has parted.
    pub(super) fn symmetrise(&mut self) {
        for p in 0..self.len.min(POINTS) {
            for q in 0..=p {
                let mean = (self.stiffness[p][q] + self.stiffness[q][p].transpose()) * 0.5;
                self.stiffness[p][q] = mean;
                self.stiffness[q][p] = mean.transpose();
            }
        }
    }

    fn add_force(&mut self, point: usize, force: Vec3) {
        if let Some(sum) = self.force.get_mut(point) {
            *sum += force;
        }
    }

    fn add_block(&mut self, [r, c]: [usize; 2], block: &Mat3) {
        if let Some(sum) = self.stiffness.get_mut(r).and_then(|row| row.get_mut(c)) {
            *sum += block;
        }
    }
}

/// An eliminated node: its displacement is `alone − next·u₊₁ − onto·y`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Row {
    pub(super) alone: Vec3,
    pub(super) next: Mat3,
    pub(super) onto: Mat3,
}

/// Where the thread passes eyelets: the node before them goes by −Σ `columns`ⱼ cⱼ, beside what its row says; the nodes behind see
/// y = Σ `seen`ⱼ cⱼ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    pub(super) link: usize,
    /// First and last eyelet of the link, and one more.
    pub(super) eyelets: [usize; 2],
    /// See [`super::chain::Chain::tangents`].
    pub(super) tangents: [Vec3; 2],
    pub(super) columns: [Mat3; PUNCTURES],
    pub(super) seen: [Mat3; PUNCTURES],
}

impl Default for Crossing {
    fn default() -> Self {
        Self {
            link: 0,
            eyelets: [0; 2],
            tangents: [Vec3::zeros(); 2],
            columns: [Mat3::zeros(); PUNCTURES],
            seen: [Mat3::zeros(); PUNCTURES],
        }
    }
}

impl Crossing {
    /// Its eyelets.
    pub(super) const fn range(&self) -> Range<usize> {
        let [start, end] = self.eyelets;
        start..end
    }
}

/// What the eliminated nodes of a thread that bends leave to the node after the next, and to both.
#[derive(Clone, Copy, Default)]
struct Ahead {
    force: Vec3,
    block: Mat3,
    /// Block of the next node with that one.
    between: Mat3,
    /// Its block with y.
    onto: Mat3,
}

/// What the eliminated nodes leave to the next node and to y.
#[derive(Clone, Copy, Default)]
pub(super) struct Front {
    pub(super) force: Vec3,
    pub(super) block: Mat3,
    /// Block of the next node with y; nothing before the first eyelet.
    onto: Option<Mat3>,
    y_force: Vec3,
    y_block: Mat3,
    /// Nothing unless the thread bends, and nothing next to an eyelet.
    ahead: Ahead,
}

impl Front {
    /// Eliminates the node at the front, which `link` joins to the next.
    #[inline]
    pub(super) fn eliminate(&mut self, link: &Link) -> Row {
        let factor = Factor::new(&(self.block + link.block));
        let mut row = Row {
            alone: factor.solve(self.force + link.on_a),
            next: factor.solve_columns(&-link.block),
            onto: Mat3::zeros(),
        };
        self.force = link.block * row.alone - link.on_a;
        self.block = link.block + link.block * row.next;
        if let Some(onto) = &mut self.onto {
            let to_y = onto.transpose();
            row.onto = factor.solve_columns(onto);
            self.y_force -= to_y * row.alone;
            self.y_block -= to_y * row.onto;
            *onto = link.block * row.onto;
        }
        row
    }

    /// The same where the thread bends; beside the row it gives what the node's displacement has of the one after the next, negated: `joint` is
    /// that of the node at the front and the two behind it.
    pub(super) fn bend(&mut self, link: &Link, joint: &Joint) -> (Row, Mat3) {
        let stiffness = joint.stiffness;
        let times = Mat3::from_diagonal_element;
        let factor = Factor::new(&(self.block + link.block + times(stiffness)));
        let to_b = self.ahead.between - link.block - times(2.0 * stiffness);
        let from_b = to_b.transpose();
        let mut row = Row {
            alone: factor.solve(self.force + link.on_a + joint.on_a),
            next: factor.solve_columns(&to_b),
            onto: Mat3::zeros(),
        };
        let beyond = factor.solve_columns(&times(stiffness));
        let ahead = self.ahead;
        self.force = ahead.force - link.on_a - joint.on_a * 2.0 - from_b * row.alone;
        self.block = ahead.block + link.block + times(4.0 * stiffness) - from_b * row.next;
        self.ahead = Ahead {
            force: joint.on_a - row.alone * stiffness,
            block: times(stiffness) - beyond * stiffness,
            between: times(-2.0 * stiffness) - from_b * beyond,
            onto: Mat3::zeros(),
        };
        if let Some(onto) = &mut self.onto {
            let to_y = onto.transpose();
            row.onto = factor.solve_columns(onto);
            self.y_force -= to_y * row.alone;
            self.y_block -= to_y * row.onto;
            *onto = ahead.onto - from_b * row.onto;
            self.ahead.onto = row.onto * -stiffness;
        }
        (row, beyond)
    }

    /// The same where `forces` of a chain join the node to the next through the eyelets of `crossing`; `passed` says what the
    /// nodes so far see of the eyelets beyond.
    pub(super) fn cross(
        &mut self,
        forces: &Forces,
        crossing: &mut Crossing,
        passed: &[Mat3; PUNCTURES],
        reduced: &mut Condensed,
    ) -> Row {
        let eyelets = crossing.range();
        self.gather((passed, eyelets.end), reduced);
        let (inner, b) = (eyelets.len(), eyelets.len() + 1);
        let onto = self.onto.unwrap_or_default();
        let mut columns: [Mat3; PUNCTURES] =
            core::array::from_fn(|j| onto * passed.get(j).copied().unwrap_or_default());
        // In order from node a the newest eyelet comes first.
        let corner = |index: usize| eyelets.end - index;
        for c in 1..=inner {
            let point = corner(c) + 1;
            if let (Some(column), Some(force)) = (columns.get_mut(corner(c)), forces.on.get(c)) {
                *column += forces.block(0, c);
                reduced.add_force(point, *force);
            }
            for r in 1..=inner {
                reduced.add_block([corner(r) + 1, point], &forces.block(r, c));
            }
        }
        let factor = Factor::new(&(self.block + forces.block(0, 0)));
        let (to_b, on) = (forces.block(b, 0), |index: usize| {
            forces.on.get(index).copied().unwrap_or_default()
        });
        let row = Row {
            alone: factor.solve(self.force + on(0)),
            next: factor.solve_columns(&to_b.transpose()),
            onto: Mat3::zeros(),
        };
        crossing.columns = [Mat3::zeros(); PUNCTURES];
        crossing.seen = [Mat3::zeros(); PUNCTURES];
        let reached = eyelets.start..reduced.len - 1;
        let answers = crossing.columns.iter_mut().zip(&mut crossing.seen);
        let answers = answers.zip(&columns).enumerate();
        for (j, ((answer, seen), column)) in answers.skip(reached.start).take(reached.len()) {
            *answer = factor.solve_columns(column);
            let own = if eyelets.contains(&j) { eyelets.end - j } else { CORNERS };
            *seen = forces.block(b, own) - to_b * *answer;
            reduced.add_force(j + 1, -(column.transpose() * row.alone));
            for (i, other) in columns.iter().enumerate().skip(reached.start).take(reached.len()) {
                reduced.add_block([i + 1, j + 1], &-(other.transpose() * *answer));
            }
        }
        *self = Self {
            force: on(b) - to_b * row.alone,
            block: forces.block(b, b) - to_b * row.next,
            onto: Some(forces.end.split(&mut crossing.seen, eyelets.start)),
            y_force: Vec3::zeros(),
            y_block: Mat3::zeros(),
            ahead: Ahead::default(),
        };
        row
    }

    /// Ends the elimination: what is left is on the tail, if `held`, and on the eyelets.
    pub(super) fn end(&self, held: bool, passed: &[Mat3; PUNCTURES], reduced: &mut Condensed) {
        self.gather((passed, 0), reduced);
        if !held {
            return;
        }
        reduced.add_force(TAIL, self.force);
        reduced.add_block([TAIL, TAIL], &self.block);
        let onto = self.onto.unwrap_or_default();
        for (j, seen) in passed.iter().enumerate().take(reduced.len - 1) {
            let shared = onto * seen;
            reduced.add_block([TAIL, j + 1], &shared);
            reduced.add_block([j + 1, TAIL], &shared.transpose());
        }
    }

    /// Spreads what is on y over the eyelets from the first on that is passed.
    fn gather(&self, (passed, first): (&[Mat3; PUNCTURES], usize), reduced: &mut Condensed) {
        let eyelets = reduced.len - 1;
        for (j, seen) in passed.iter().enumerate().take(eyelets).skip(first) {
            reduced.add_force(j + 1, seen.transpose() * self.y_force);
            let column = self.y_block * seen;
            for (i, other) in passed.iter().enumerate().take(eyelets).skip(first) {
                reduced.add_block([i + 1, j + 1], &(other.transpose() * column));
            }
        }
    }
}
