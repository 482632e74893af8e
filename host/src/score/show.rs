//! The score card as text.

use std::fmt::{self, Display, Formatter};

use super::table::{MARKS, Mark};
use super::{Row, Score, Threshold};

impl Display for Score {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:<46}{:>10}  {:<5}{:>16}{:>8}{:>10}",
            "score", "value", "", "published", "met", "points"
        )?;
        for row in self.rows.iter().filter(|row| row.stage.is_none()) {
            let (value, threshold, met) = (row.shown(), row.limit(), row.met());
            writeln!(
                f,
                "{:<46}{value:>10}  {:<5}{threshold:>16}{met:>8}{:>10}",
                row.label(),
                row.unit,
                row.counted()
            )?;
        }
        writeln!(f, "{:<46}{:>51}", "total, out of 100", format!("{:.1}", self.total))?;
        write!(f, "{}", self.note)
    }
}

impl Score {
    /// The card as Markdown, sources included.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text = format!("# Score: {:.1} of 100\n\n{}\n\n", self.total, self.note);
        text += "| | value | unit | published threshold | met | points | source |\n|---|---|---|---|---|---|---|\n";
        for row in &self.rows {
            text += &format!(
                "| {} | {} | {} | {} | {} | {} | {} |\n",
                row.label(),
                row.shown(),
                row.unit,
                row.limit(),
                row.met(),
                row.counted(),
                row.source
            );
        }
        text += "\nA miss of `half` leaves half of a row's points: weight · half/(half + miss). The halves are scales of this score, not thresholds.\n";
        text += "\n| counts | weight | half | unit | because |\n|---|---|---|---|---|\n";
        for Mark {
            kind,
            weight,
            half,
            reason,
            ..
        } in &MARKS
        {
            text += &format!("| {} | {weight} | {half} | {} | {reason} |\n", kind.name, kind.unit);
        }
        text
    }
}

impl Row {
    /// What it is, of which stitch or stage.
    fn label(&self) -> String {
        match (self.stitch, self.stage, self.best) {
            (Some(stitch), _, Some(best)) => format!("{}, stitch {stitch} (best: {best:.1})", self.name),
            (Some(stitch), _, None) => format!("{}, stitch {stitch}", self.name),
            (None, Some(stage), _) => format!("{}, {stage}", self.name),
            (None, None, _) => self.name.to_owned(),
        }
    }

    fn shown(&self) -> String {
        self.value
            .map_or_else(|| "not reached".to_owned(), |value| format!("{value:.3}"))
    }

    fn limit(&self) -> String {
        match self.threshold {
            None => "none".to_owned(),
            Some(Threshold::AtMost(most)) => format!("at most {most}"),
            Some(Threshold::Within([least, most])) => format!("{least} to {most}"),
            Some(Threshold::Ideal(ideal)) => format!("ideal {ideal}"),
        }
    }

    const fn met(&self) -> &'static str {
        match self.meets {
            None => "",
            Some(true) => "yes",
            Some(false) => "no",
        }
    }

    fn counted(&self) -> String {
        self.points
            .map_or_else(String::new, |points| format!("{:.2}/{:.2}", points.got, points.of))
    }
}
