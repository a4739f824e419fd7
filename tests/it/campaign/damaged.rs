//! Damaged tables: refused or read, never a panic.

use super::*;

#[test]
fn a_table_with_a_damaged_byte_is_read_or_refused() {
    let folder = folder();
    let file = short(folder.path(), "independent");
    let out = folder.path().join("out");
    campaign(&file, 8, &out, &["--seed", "4", "--json"]);
    let sound = fs::read(out.join("runs.parquet")).expect("a table");
    let names = column_names(&out.join("runs.parquet")).expect("columns");
    let damaged = folder.path().join("damaged.parquet");
    let (mut read, mut refused) = (0, 0);
    let step = (sound.len() / 1500).max(1);
    for place in (0..sound.len()).step_by(step) {
        let mut bytes = sound.clone();
        bytes[place] ^= 0xff;
        fs::write(&damaged, &bytes).expect("written");
        for name in names.iter().step_by(7) {
            match column_f64(&damaged, name) {
                Ok(_) => read += 1,
                Err(error) => {
                    assert!(!error.to_string().is_empty());
                    refused += 1;
                }
            }
        }
    }
    assert!(read > 100 && refused > 100, "{read} {refused}");
}
