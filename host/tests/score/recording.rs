//! A recording made up tick by tick, in a folder as a run leaves it.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;

use sutura::score::{self, Score};

/// Radius and length of the built-in scene's needle, half a circle [m].
pub(crate) const LENGTH: f64 = 0.026;
pub(crate) const RADIUS: f64 = LENGTH / PI;
/// The tip is two thirds of the length ahead of the grasp.
pub(crate) const TIP: f64 = 2.0 / 3.0 * PI;

/// A recording, tick by tick.
#[derive(Default)]
pub(crate) struct Recording {
    force: String,
    motion: String,
    punctures: String,
    stitches: u32,
    ticks: usize,
}

/// One tick: stage, grasp point [m], angle ψ of the grasp from x towards z in the plane y = const [rad], simulated and side force,
/// tension on the needle and in the stitch [N], gap [mm].
pub(crate) struct Tick {
    pub(crate) stage: &'static str,
    pub(crate) position: [f64; 3],
    pub(crate) psi: f64,
    pub(crate) force: f64,
    pub(crate) side: f64,
    pub(crate) tension: [f64; 2],
    pub(crate) gap: f64,
}

pub(crate) const STILL: Tick = Tick {
    stage: "approach",
    position: [0.0; 3],
    psi: 0.0,
    force: 0.0,
    side: 0.0,
    tension: [0.0; 2],
    gap: 4.0,
};

impl Recording {
    pub(crate) fn tick(&mut self, tick: &Tick) {
        self.ticks += 1;
        let Tick {
            stage,
            position: [x, y, z],
            psi,
            force,
            side,
            tension: [needle, stitch],
            gap,
        } = tick;
        let n = self.ticks;
        writeln!(self.force, "{n},{stage},{x},{y},{z},{force},{force},{needle},{gap}").unwrap();
        // The needle's x at ψ from x towards z, its z against the patch's y: a quarter turn about x, then −ψ about the patch's y.
        let (half, quarter) = (-psi / 2.0, PI / 4.0);
        let (w, i) = (half.cos() * quarter.cos(), half.cos() * quarter.sin());
        let (j, k) = (half.sin() * quarter.cos(), -half.sin() * quarter.sin());
        writeln!(self.motion, "{n},{w},{i},{j},{k},{side},{stitch},0.009,1,-0.4,0.7").unwrap();
    }

    pub(crate) fn puncture(&mut self, stitch: u32, site: &str, [x, y, z]: [f64; 3]) {
        self.stitches = self.stitches.max(stitch);
        writeln!(
            self.punctures,
            "{},{stitch},{site},{x},{y},{z},0.95,0.95,1.5",
            self.ticks
        )
        .unwrap();
    }

    pub(crate) fn write(&self, folder: &Path) {
        let put = |name: &str, head: &str, lines: &str| {
            std::fs::write(folder.join(name), format!("{head}\n{lines}")).unwrap()
        };
        let scene = match self.stitches {
            0 | 1 => sutura::scene::BUILT_IN.to_owned(),
            n => sutura::scene::BUILT_IN
                .replace("bite_mm = 4 ", &format!("stitches = {n}\nspacing_mm = 6\nbite_mm = 4 ")),
        };
        std::fs::write(folder.join("scene.toml"), scene).unwrap();
        put(
            "force.csv",
            "tick,stage,x_m,y_m,z_m,simulated_n,rendered_n,thread_n,gap_mm",
            &self.force,
        );
        put(
            "motion.csv",
            "tick,qw,qx,qy,qz,side_n,stitch_n,stitch_m,stitch,step_mm,closing_n",
            &self.motion,
        );
        put(
            "punctures.csv",
            "tick,stitch,site,x_m,y_m,z_m,force_n,f0_n,depth_mm",
            &self.punctures,
        );
    }

    pub(crate) fn scored(&self) -> Score {
        let folder = tempfile::tempdir().unwrap();
        self.write(folder.path());
        score::of(folder.path()).unwrap()
    }
}
