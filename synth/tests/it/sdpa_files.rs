//! Reading SDPA sparse files.

use crate::semidefinite;
use synth::lmi::{SdpaError, Semidefinite};

const SMALL: &str = "\"a comment\n* another\n 2 = unknowns\n3 = blocks\n(2, -2, 1)\n{1.5, -2}\n\
                     0 1 1 1 -1.0\n1 1 2 1 3e0\n2 2 2 2 5\n2 3 1 1 1\n";

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
    // Given below the diagonal, kept above it.
    assert_eq!((*unknown, entries.len()), (0, 1));
    assert_eq!(
        (entries[0].row, entries[0].column, entries[0].value),
        (0, 1, 3.0)
    );
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
    for wrong in ["1 1 1 1 one", "1 1 1 1 nan", "1 1 1 1 1e400", "1.5 1 1 1 1"] {
        let refused = with(wrong);
        let named = matches!(refused, SdpaError::NotANumber { line: 5, .. });
        assert!(named, "{wrong}: {refused}");
    }
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

#[test]
fn a_number_missing_in_a_list_is_never_taken_from_the_next_line() {
    let short = |line, what, expected, found| SdpaError::WrongCount {
        line,
        what,
        expected,
        found,
    };
    // Two costs of three, then an entry; then a line of two entries.
    let entry = "3\n1\n2\n1 4\n0 1 1 2 3\n1 1 1 1 1\n";
    assert_eq!(refusal(entry), short(5, "the costs", 3, 2));
    let entries = "12\n1\n2\n1 4\n0 1 1 2 3 1 1 1 1 1\n2 1 2 2 1\n";
    assert_eq!(refusal(entries), short(5, "the costs", 12, 2));
    // One size of two, then the costs.
    let sizes = "3\n2\n2\n1 4 5\n0 1 1 2 3\n";
    assert_eq!(refusal(sizes), short(4, "the sizes of the blocks", 2, 4));
    // No costs at all.
    let none = "3\n1\n2\n0 1 1 2 3\n1 1 1 1 1\n";
    assert_eq!(refusal(none), short(4, "the costs", 3, 5));
    // Both counts on one line.
    let counts = refusal("3 1\n2\n1 4 5\n");
    assert!(
        matches!(counts, SdpaError::NumberFollows { line: 1, .. }),
        "{counts}"
    );
    // A list that goes on on the next line is read.
    let broken = Semidefinite::from_sdpa("3\n1\n2\n1 4\n5\n0 1 1 2 3\n1 1 1 1 1\n").unwrap();
    assert_eq!(broken.cost, [1.0, 4.0, 5.0]);
}

#[test]
fn blocks_that_no_memory_holds_are_refused() {
    let many = format!("1\n3\n{0} {0} {0}\n1\n", -400_000);
    let refused = refusal(&many);
    let rows = matches!(
        refused,
        SdpaError::TooManyRows {
            line: 3,
            rows: 1_200_000,
            ..
        }
    );
    assert!(rows, "{refused}");
}
