//! SDPA sparse text (.dat-s), read by csdp, sdpa and others.
//!
//! The format states `min c'y  s.t.  sum_i y_i F_i - F_0 >= 0`, so F_0 is minus our constant. The
//! first lines that start with a double quote are comments.

use std::fmt::Write;

use super::{Entry, Semidefinite};

impl Semidefinite {
    /// The problem as SDPA sparse text. The comments name every block and the constant that must be
    /// added to the objective value. Numbers are written so that they read back exactly.
    pub fn to_sdpa(&self, title: &str) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_sdpa(&mut out, title);
        out
    }

    fn write_sdpa(&self, out: &mut String, title: &str) -> std::fmt::Result {
        writeln!(out, "\"{}", title.replace('\n', " "))?;
        writeln!(out, "\"objective offset {:e}", self.offset)?;
        for (block, cone) in self.cones.iter().enumerate() {
            writeln!(
                out,
                "\"block {} side {}: {}",
                block + 1,
                cone.side,
                cone.name
            )?;
        }
        writeln!(out, "{}", self.cost.len())?;
        writeln!(out, "{}", self.cones.len())?;
        let sides = self.cones.iter().map(|cone| cone.side.to_string());
        writeln!(out, "{}", sides.collect::<Vec<_>>().join(" "))?;
        let costs = self.cost.iter().map(|cost| format!("{cost:e}"));
        writeln!(out, "{}", costs.collect::<Vec<_>>().join(" "))?;
        for (block, cone) in self.cones.iter().enumerate() {
            write_entries(out, 0, block, &cone.constant, -1.0)?;
        }
        let cones = self.cones.iter().enumerate();
        let mut coefficients: Vec<_> = cones
            .flat_map(|(block, cone)| cone.coefficients.iter().map(move |(u, e)| (*u, block, e)))
            .collect();
        coefficients.sort_by_key(|&(unknown, block, _)| (unknown, block));
        for (unknown, block, entries) in coefficients {
            write_entries(out, unknown + 1, block, entries, 1.0)?;
        }
        Ok(())
    }
}

fn write_entries(
    out: &mut String,
    matrix: usize,
    block: usize,
    entries: &[Entry],
    sign: f64,
) -> std::fmt::Result {
    for entry in entries {
        let (row, column) = (entry.row + 1, entry.column + 1);
        writeln!(
            out,
            "{matrix} {} {row} {column} {:e}",
            block + 1,
            sign * entry.value
        )?;
    }
    Ok(())
}
