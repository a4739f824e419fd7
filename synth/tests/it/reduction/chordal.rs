//! Chordal splits of random patterned matrices: exact parts, and patterns that are refused.

use super::*;

/// Random symmetric blocks where `meets` says so, made positive definite.
fn patterned(
    stream: &mut Stream,
    sizes: &[usize],
    meets: impl Fn(usize, usize) -> bool,
) -> DMatrix<f64> {
    let side = sizes.iter().sum();
    let offsets = offsets(sizes);
    let mut out = DMatrix::zeros(side, side);
    for (j, &columns) in sizes.iter().enumerate() {
        for (i, &rows) in sizes.iter().enumerate().take(j + 1) {
            let block = match i == j {
                true => positive_definite(stream, rows),
                false if meets(i, j) => uniform(stream, rows, columns, 1.0),
                false => continue,
            };
            out.view_mut((offsets[i], offsets[j]), (rows, columns))
                .copy_from(&block);
            out.view_mut((offsets[j], offsets[i]), (columns, rows))
                .copy_from(&block.transpose());
        }
    }
    let smallest = smallest_eigenvalue(&out);
    out + DMatrix::identity(side, side) * (0.1 - smallest.min(0.0))
}

/// Cliques {0, 2}, {1, 2, 3}, {2, 3, 4}, in this order.
fn chordal_splits() -> Vec<Split> {
    let split = |name, residual, separator| Split {
        name,
        residual,
        separator,
    };
    vec![
        split("first", vec![0], vec![2]),
        split("second", vec![1], vec![3, 2]),
    ]
}

fn chordal(i: usize, j: usize) -> bool {
    !matches!((i, j), (0, 1) | (0, 3) | (0, 4) | (1, 4))
}

#[test]
fn the_parts_of_a_split_add_up_to_the_whole_whatever_the_separators() {
    let mut stream = Stream(4);
    for _ in 0..20 {
        let sizes: Vec<usize> = (0..5).map(|_| stream.integer(1, 3) as usize).collect();
        let whole = patterned(&mut stream, &sizes, chordal);
        let mut unknowns = Unknowns::new();
        let parts = split(
            &Affine::constant(&whole),
            &sizes,
            &chordal_splits(),
            &mut unknowns,
        );
        let parts = parts.expect("a chordal pattern");
        let values: Vec<f64> = (0..unknowns.count())
            .map(|_| stream.signed_unit())
            .collect();
        let blocks: [&[usize]; 3] = [&[0, 2], &[1, 3, 2], &[2, 3, 4]];
        let names: Vec<&str> = parts.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["first", "second", "root"]);
        let sum = parts
            .iter()
            .zip(blocks)
            .fold(0.0 * &whole, |sum, ((_, part), blocks)| {
                sum + embedded(
                    &part.value(&values),
                    &rows_of(blocks, &sizes),
                    whole.nrows(),
                )
            });
        assert_close(&sum, &whole, 1e-14, "sum of the parts");
        // The separator matters: the parts alone change with it.
        assert!(
            unknowns.count() > 0
                && parts[0].1.value(&values) != parts[0].1.value(&vec![0.0; values.len()])
        );
    }
}

#[test]
fn a_pattern_that_is_not_chordal_is_refused_with_the_block_named() {
    let mut stream = Stream(9);
    let sizes = [1, 2, 1, 2];
    // The cycle 0 - 1 - 2 - 3 - 0.
    let cycle = |i: usize, j: usize| (i + 1) % 4 == j || (j + 1) % 4 == i;
    let whole = Affine::constant(&patterned(&mut stream, &sizes, cycle));
    let attempt = |splits: &[Split]| split(&whole, &sizes, splits, &mut Unknowns::new());
    let step = |residual: usize, separator: &[usize]| Split {
        name: "part",
        residual: vec![residual],
        separator: separator.to_vec(),
    };
    let refused = attempt(&[step(0, &[1])]).expect_err("block 0 meets block 3");
    assert_eq!(
        refused,
        NotChordal {
            residual: 0,
            other: 3
        }
    );
    assert_eq!(
        refused.to_string(),
        "block 0 still meets block 3, which is not in its separator"
    );
    // Splitting 0 off joins 1 and 3.
    let refused = attempt(&[step(0, &[1, 3]), step(1, &[2])]).expect_err("1 and 3 are joined");
    assert_eq!(
        refused,
        NotChordal {
            residual: 1,
            other: 3
        }
    );
    assert!(attempt(&[step(0, &[1, 3]), step(1, &[2, 3])]).is_ok());
}

#[test]
fn a_positive_definite_matrix_splits_into_positive_semidefinite_parts() {
    let mut stream = Stream(6);
    for _ in 0..20 {
        let sizes: Vec<usize> = (0..5).map(|_| stream.integer(1, 3) as usize).collect();
        let mut rest = patterned(&mut stream, &sizes, chordal);
        let mut unknowns = Unknowns::new();
        let splits = chordal_splits();
        let parts = split(&Affine::constant(&rest), &sizes, &splits, &mut unknowns);
        let parts = parts.expect("a chordal pattern");
        let mut values = Vec::new();
        for step in &splits {
            let residual = rows_of(&step.residual, &sizes);
            let separator = rows_of(&step.separator, &sizes);
            let corner = rest.select_rows(&residual).select_columns(&residual);
            let beside = rest.select_rows(&separator).select_columns(&residual);
            let shared = &beside * corner.try_inverse().expect("definite") * beside.transpose();
            for column in 0..shared.ncols() {
                values.extend((0..=column).map(|row| shared[(row, column)]));
            }
            rest -= embedded(&shared, &separator, rest.nrows());
        }
        assert_eq!(values.len(), unknowns.count());
        for (name, part) in &parts {
            assert!(smallest_eigenvalue(&part.value(&values)) > -1e-12, "{name}");
        }
    }
}
