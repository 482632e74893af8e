//! What becomes of each odd or broken STL file: a golden table, reviewed file by file.
//!
//! `UPDATE_GOLDEN=1` writes the table anew; its difference is then for a person to read.

use std::fmt::Write;
use std::{env, fs};

use sutura::geometry::stl;

#[test]
fn every_odd_file_gives_triangles_with_warnings_or_one_line() {
    let root = sutura_tests::root();
    let Some(folder) = sutura_tests::shared("odd_stl", "data/odd_stl") else {
        return;
    };
    let entries = fs::read_dir(folder).unwrap();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut table = String::new();
    for file in files {
        let name = file.file_name().unwrap().to_string_lossy();
        match stl::parse(&fs::read(&file).unwrap()) {
            Ok(reading) => {
                let triangles = reading.mesh.triangles.len();
                writeln!(table, "{name}: {triangles} triangles, solids: {}", reading.solids).unwrap();
                for warning in reading.warnings {
                    writeln!(table, "    {warning}").unwrap();
                }
            }
            Err(fault) => writeln!(table, "{name}: error: {fault}").unwrap(),
        }
    }
    let golden = root.join("tests/golden/odd_stl.txt");
    if env::var_os("UPDATE_GOLDEN").is_some() {
        fs::write(&golden, &table).unwrap();
    }
    assert_eq!(table, fs::read_to_string(&golden).unwrap());
}
