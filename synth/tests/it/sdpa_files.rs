//! Reading SDPA sparse files.

use crate::semidefinite;
use synth::lmi::{SdpaError, Semidefinite};

const SMALL: &str = "\"a comment\n* another\n 2 = unknowns\n3 = blocks\n(2, -2, 1)\n{1.5, -2}\n\
                     0 1 1 1 -1.0\n1 1 1 2 3e0\n1 1 2 1 1\n2 2 2 2 5\n2 3 1 1 1\n";

#[test]
fn a_file_with_remarks_braces_and_a_diagonal_block_is_read() {
    let problem = Semidefinite::from_sdpa(SMALL).unwrap();
    assert_eq!(problem.cost, [1.5, -2.0]);
    let names: Vec<(&str, usize)> = problem
        .cones
        .iter()
        .map(|cone| (cone.name.as_str(), cone.side))
        .collect();
    let known = [
        ("block 1", 2),
        ("block 2 row 1", 1),
        ("block 2 row 2", 1),
        ("block 3", 1),
    ];
    assert_eq!(names, known);
    assert_eq!(problem.cones[0].constant[0].value, 1.0);
    let (unknown, entries) = &problem.cones[0].coefficients[0];
    // Both triangles of one entry are added.
    assert_eq!((*unknown, entries.len(), entries[0].value), (0, 1, 4.0));
    assert_eq!(problem.cones[2].coefficients[0].0, 1);
}

fn sorted_lines(text: &str) -> Vec<&str> {
    let mut lines: Vec<_> = text.lines().collect();
    lines.sort_unstable();
    lines
}

#[test]
fn what_was_written_is_read_back_exactly() {
    for seed in 0..20 {
        let mut problem = semidefinite::feasible(seed);
        problem
            .cones
            .iter_mut()
            .for_each(|cone| cone.constant.retain(|e| e.value != 0.0));
        let text = problem.to_sdpa("round trip");
        let again = Semidefinite::from_sdpa(&text).unwrap();
        // The reader puts the entries of a matrix in order.
        assert_eq!(
            sorted_lines(&again.to_sdpa("round trip")),
            sorted_lines(&text)
        );
        assert_eq!(again.offset, problem.offset);
        assert_eq!(again.cones[0].name, problem.cones[0].name);
    }
}

#[track_caller]
fn refusal(text: &str) -> SdpaError {
    Semidefinite::from_sdpa(text).unwrap_err()
}

#[test]
fn mistakes_are_named_with_their_line() {
    assert!(matches!(refusal(""), SdpaError::Ends { .. }));
    assert!(matches!(
        refusal("2\n1\n2\n1.0\n"),
        SdpaError::Ends { what: "the costs" }
    ));
    assert!(matches!(
        refusal("x\n"),
        SdpaError::NotANumber { line: 1, .. }
    ));
    assert!(matches!(
        refusal("-1\n"),
        SdpaError::OutOfRange {
            line: 1,
            value: -1,
            ..
        }
    ));
    assert!(matches!(
        refusal("1\n1\n0\n1\n"),
        SdpaError::OutOfRange {
            line: 3,
            value: 0,
            ..
        }
    ));
    assert!(matches!(
        refusal("99999999999\n"),
        SdpaError::OutOfRange { .. }
    ));
    let with = |entry: &str| refusal(&format!("1\n2\n2 -2\n1\n{entry}\n"));
    assert_eq!(with("1 1 1 1"), SdpaError::NotAnEntry { line: 5, found: 4 });
    assert!(matches!(
        with("2 1 1 1 1"),
        SdpaError::OutOfRange {
            what: "the matrix",
            ..
        }
    ));
    assert!(matches!(
        with("1 3 1 1 1"),
        SdpaError::OutOfRange {
            what: "the block",
            ..
        }
    ));
    assert!(matches!(
        with("1 1 3 1 1"),
        SdpaError::OutOfRange {
            what: "the row",
            ..
        }
    ));
    assert!(matches!(
        with("1 1 1 1 one"),
        SdpaError::NotANumber { line: 5, .. }
    ));
    assert!(matches!(
        with("1 2 1 2 1"),
        SdpaError::OffDiagonal {
            block: 2,
            row: 1,
            column: 2,
            ..
        }
    ));
}
