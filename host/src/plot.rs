//! Force over time as a picture: stages as bands, punctures marked (Lian & Chen Fig. 19); and the studies' pictures.

pub mod accuracy;
pub mod bars;
pub mod budget;
pub mod curve;
pub mod matrix;
pub mod pitch;
pub mod wound;

use std::path::Path;
use std::sync::OnceLock;

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::register_font;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use sutura_shared::message::Telemetry;

use crate::run::log::{Log, length};

/// Size of the picture [pixels].
const SIZE: (u32, u32) = (1600, 900);
/// Least thickness of the curves over the height of the picture: thick below thin, for two that coincide.
const THICKNESS: [f64; 3] = [0.009, 0.004, 0.004];
/// Most pieces of a curve: about one for each column of pixels.
const PIECES: usize = 1400;
/// Distance of a stage's name from its beginning, over the whole time.
const NAME: f64 = 0.006;
const FONT: &str = "sans-serif";
const SIMULATED: RGBColor = RGBColor(120, 165, 225);
const RENDERED: RGBColor = RGBColor(222, 110, 20);
const THREAD: RGBColor = RGBColor(30, 140, 70);
const BANDS: [RGBColor; 2] = [RGBColor(244, 244, 240), RGBColor(228, 232, 238)];
const INK: RGBColor = RGBColor(50, 50, 60);

/// Draws a run into a PNG file.
///
/// # Errors
/// The picture cannot be drawn or written.
pub fn force(path: &Path, title: &str, log: &Log) -> Result<(), Error> {
    fonts()?;
    let fault = |cause: DrawingAreaErrorKind<_>| Error::Draw(cause.to_string());
    let root = BitMapBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE).map_err(fault)?;
    let end = log.ticks.last().map_or(1.0, |tick| seconds(tick.tick));
    let peaks = log
        .ticks
        .iter()
        .map(|tick| length(tick.simulated_n).max(length(tick.rendered_n)).max(tick.thread_n));
    // Room above the curves for the names of the stages.
    let top = f64::from(peaks.fold(0.5, f32::max)) * 1.35;
    let mut chart = ChartBuilder::on(&root)
        .caption(title, (FONT, 34).into_font().color(&INK))
        .margin(24)
        .x_label_area_size(64)
        .y_label_area_size(84)
        .build_cartesian_2d(0.0..end, 0.0..top)
        .map_err(fault)?;
    bands(&mut chart, log, [end, top]).map_err(fault)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc("time [s]")
        .y_desc("force [N]")
        .label_style((FONT, 24).into_font().color(&INK))
        .axis_desc_style((FONT, 28).into_font().color(&INK))
        .draw()
        .map_err(fault)?;
    curves(&mut chart, log, top).map_err(fault)?;
    punctures(&mut chart, log, top).map_err(fault)?;
    root.present().map_err(fault)
}

type Chart<'a> = ChartContext<'a, BitMapBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
/// What a curve shows [N].
type Quantity = fn(&Telemetry) -> f32;
type Drawn = Result<(), DrawingAreaErrorKind<<BitMapBackend<'static> as DrawingBackend>::ErrorType>>;

/// Stages as bands, named at the top.
fn bands(chart: &mut Chart<'_>, log: &Log, [end, top]: [f64; 2]) -> Drawn {
    let upright = FontTransform::Rotate270;
    let style = (FONT, 24)
        .into_font()
        .transform(upright)
        .color(&INK)
        .pos(Pos::new(HPos::Right, VPos::Top));
    for (i, stage) in log.stages().iter().enumerate() {
        let (from, to) = (seconds(stage.from_tick - 1), seconds(stage.to_tick));
        chart.draw_series([Rectangle::new(
            [(from, 0.0), (to, top)],
            BANDS[i % BANDS.len()].filled(),
        )])?;
        chart.draw_series([Text::new(stage.name, (from + end * NAME, top * 0.99), style.clone())])?;
    }
    Ok(())
}

fn curves(chart: &mut Chart<'_>, log: &Log, top: f64) -> Drawn {
    let curves: [(&str, RGBColor, Quantity); 3] = [
        ("simulated", SIMULATED, |tick| length(tick.simulated_n)),
        ("rendered", RENDERED, |tick| length(tick.rendered_n)),
        ("thread tension", THREAD, |tick| tick.thread_n),
    ];
    let piece = log.ticks.len().div_ceil(PIECES).max(1);
    for ((name, colour, of), thickness) in curves.into_iter().zip(THICKNESS) {
        let band = band(&log.ticks, piece, of, thickness * top);
        chart
            .draw_series([Polygon::new(band, colour.filled())])?
            .label(name)
            .legend(move |(x, y)| Rectangle::new([(x, y - 3), (x + 36, y + 3)], colour.filled()));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::Coordinate(20, 150))
        .legend_area_size(48)
        .label_font((FONT, 24).into_font().color(&INK))
        .background_style(WHITE.mix(0.85))
        .border_style(INK.mix(0.3))
        .draw()
}

/// The outline of least and largest value of every `piece` ticks, each with the tick after it, so that no peak is lost and no column is empty.
fn band(ticks: &[Telemetry], piece: usize, of: Quantity, thickness: f64) -> Vec<(f64, f64)> {
    let ends = |start: usize| {
        let values = || ticks.iter().skip(start).take(piece + 1).map(|tick| f64::from(of(tick)));
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
        let at = ticks
            .get(start + piece / 2)
            .or(ticks.last())
            .map_or(0.0, |tick| seconds(tick.tick));
        (at, (low - thickness / 2.0).max(0.0), high + thickness / 2.0)
    };
    let pieces: Vec<_> = (0..ticks.len()).step_by(piece).map(ends).collect();
    let above = pieces.iter().map(|&(at, _, high)| (at, high));
    let below = pieces.iter().rev().map(|&(at, low, _)| (at, low));
    above.chain(below).collect()
}

fn punctures(chart: &mut Chart<'_>, log: &Log, top: f64) -> Drawn {
    for puncture in &log.punctures {
        let (at, force) = (seconds(puncture.tick), f64::from(puncture.force_n));
        let label = format!("{}, {force:.2} N", puncture.site.name());
        let style = (FONT, 22)
            .into_font()
            .color(&INK)
            .pos(Pos::new(HPos::Left, VPos::Bottom));
        chart.draw_series([PathElement::new([(at, 0.0), (at, top * 0.72)], INK.stroke_width(1))])?;
        chart.draw_series([Circle::new((at, force), 6, INK.stroke_width(2))])?;
        chart.draw_series([Text::new(label, (at, top * 0.72), style)])?;
    }
    Ok(())
}

fn seconds(tick: u32) -> f64 {
    f64::from(tick) * 1e-3
}

/// Registers the typeface that the program carries, for a machine may have none.
fn fonts() -> Result<(), Error> {
    static DONE: OnceLock<bool> = OnceLock::new();
    let register = || register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT).is_ok();
    if *DONE.get_or_init(register) {
        Ok(())
    } else {
        Err(Error::Font)
    }
}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The typeface is damaged.
    #[error("the built-in typeface cannot be read")]
    Font,
    /// The drawing library or the file system refuses.
    #[error("{0}")]
    Draw(String),
}

#[cfg(test)]
mod tests {
    use super::*;
    use sutura_shared::message::PunctureEvent;
    use sutura_shared::scene::Stage;

    #[test]
    fn a_run_gives_a_picture_of_its_size() {
        let tick = |tick: u32| Telemetry {
            tick,
            stage: if tick < 500 { Stage::Approach } else { Stage::Indent },
            stitch: 1,
            faults: 0,
            position_m: [0.0; 3],
            simulated_n: [0.0, 0.0, (tick as f32 * 1e-3).powi(2)],
            rendered_n: [0.0, 0.5 * (tick as f32 * 1e-3).powi(2), 0.0],
            torque_n_m: [0.0; 3],
            thread_n: 0.1,
            gap_m: [0.004, 0.0, 0.0],
            gap_mean_m: 0.004,
            saturated: false,
        };
        let puncture = PunctureEvent {
            site: sutura_shared::scene::Site::A,
            stitch: 1,
            tick: 900,
            force_n: 0.81,
            f0_n: 0.8,
            depth_m: 0.003,
        };
        let log = Log {
            ticks: (1..=1000).map(tick).collect(),
            punctures: vec![puncture],
            ..Log::default()
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("force.png");
        force(&path, "Force on the hand", &log).unwrap();
        let png = std::fs::read(&path).unwrap();
        // PNG, W3C: the signature, and width and height big-endian in IHDR.
        assert_eq!(png[..8], *b"\x89PNG\r\n\x1a\n");
        assert_eq!(
            [&png[16..20], &png[20..24]],
            [SIZE.0.to_be_bytes(), SIZE.1.to_be_bytes()]
        );
        if let Some(keep) = std::env::var_os("SUTURA_KEEP") {
            std::fs::copy(&path, keep).unwrap();
        }
    }
}
