//! The files that are changed: every kind that the program reads.

use std::collections::BTreeSet;
use std::path::Path;

use super::tokens::{json, words, Node, Part};

/// How a file is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reader {
    /// JSON of the kind that it says it is, as `check` reads it.
    Json,
    /// A run's `summary.json`.
    Summary,
    /// A campaign's `campaign.json`.
    Campaign,
    /// A trajectory as comma-separated values.
    Trajectory,
    /// SDPA sparse text.
    Sdpa,
    /// SDPA text in dense form.
    SdpaDense,
    /// An axis of a sweep, `key=lo:hi:n`.
    Axis,
    /// A campaign's table, in Parquet.
    Table,
}

/// A file and where its parts stand.
pub struct Seed {
    /// Its name.
    pub name: String,
    /// How it is read.
    pub reader: Reader,
    /// Its text; empty where it has none.
    pub text: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Its parts; none where it has no text.
    pub nodes: Vec<Node>,
    /// Which of them are numbers.
    pub numbers: Vec<usize>,
    /// Whether it has a proof to decide.
    pub decided: bool,
    /// Whether it has a proof that takes too long here.
    pub long: bool,
}

/// All files.
pub struct Corpus {
    /// The files, the smallest first.
    pub seeds: Vec<Seed>,
    /// The places of those that have a proof to decide, the smallest first.
    pub proofs: Vec<usize>,
    /// Their keys, with quotes.
    pub keys: Vec<String>,
}

/// Records of runs, small enough to be written here.
const SUMMARY: &str = include_str!("summary.json");
const CAMPAIGN: &str = include_str!("campaign.json");
const TABLE: &[u8] = include_bytes!("runs.parquet");
const TRAJECTORY: &str = "t,x0,x1\n0,1,0\n0.5,0.25,-0.5\n1,1e-3,-0.125\n";
const AXES: [&str; 4] = [
    "plant.exact.disturbance_bound=0.001:0.1:5:log",
    "nu=0.1,0.2,0.4",
    "specs.hbar_s=0.01:0.2:3",
    "duration_s=10:100:4",
];

impl Corpus {
    /// The files of a clone of the repository.
    ///
    /// # Errors
    /// A folder or file that cannot be read.
    pub fn load(root: &Path) -> std::io::Result<Self> {
        let mut seeds = Vec::new();
        for folder in ["models", "tests/data", "tests/data/fuzz", "tests/data/sdpa"] {
            let mut paths: Vec<_> = std::fs::read_dir(root.join(folder))?
                .map(|entry| entry.map(|entry| entry.path()))
                .collect::<Result<_, _>>()?;
            paths.sort();
            for path in paths {
                let ending = path.extension().and_then(|ending| ending.to_str());
                let reader = match ending {
                    Some("json") => Reader::Json,
                    Some("dat-s") => Reader::Sdpa,
                    Some("dat") => Reader::SdpaDense,
                    _ => continue,
                };
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                seeds.push(Seed::new(&name, reader, std::fs::read_to_string(&path)?));
            }
        }
        for (name, reader, text) in [
            ("summary.json", Reader::Summary, SUMMARY),
            ("campaign.json", Reader::Campaign, CAMPAIGN),
            ("trajectory.csv", Reader::Trajectory, TRAJECTORY),
        ] {
            seeds.push(Seed::new(name, reader, text.to_string()));
        }
        let axes = AXES.iter();
        seeds.extend(axes.map(|text| Seed::new("axis", Reader::Axis, text.to_string())));
        seeds.push(Seed::of_bytes("runs.parquet", Reader::Table, TABLE));
        seeds.sort_by_key(|seed| seed.bytes.len());
        let proofs = (0..seeds.len()).filter(|&place| seeds[place].decided);
        let proofs = proofs.collect();
        let keys: BTreeSet<String> = seeds.iter().flat_map(Seed::keys).collect();
        Ok(Corpus {
            seeds,
            proofs,
            keys: keys.into_iter().collect(),
        })
    }
}

impl Seed {
    fn new(name: &str, reader: Reader, text: String) -> Self {
        // Without blanks: shorter, and as good.
        let compact = |value: serde_json::Value| value.to_string();
        let text = match reader {
            Reader::Json | Reader::Summary | Reader::Campaign => {
                serde_json::from_str(&text).map_or(text, compact)
            }
            _ => text,
        };
        let nodes = match reader {
            Reader::Json | Reader::Summary | Reader::Campaign => json(&text),
            Reader::Table => Vec::new(),
            _ => words(&text),
        };
        let numbers = (0..nodes.len()).filter(|&k| nodes[k].part == Part::Number);
        let has = |key: &str| text.contains(key);
        let proof = reader == Reader::Json && (has("\"certificate\"") || has("\"infeasibility\""));
        // The thousands of conditions of an uncertain inertia take a second.
        let long = proof && has("\"inertia_uncertainty\"");
        Seed {
            name: name.to_string(),
            reader,
            numbers: numbers.collect(),
            decided: proof && !long,
            long,
            nodes,
            bytes: text.as_bytes().to_vec(),
            text,
        }
    }

    /// A file that is no text.
    fn of_bytes(name: &str, reader: Reader, bytes: &[u8]) -> Self {
        Seed {
            bytes: bytes.to_vec(),
            ..Seed::new(name, reader, String::new())
        }
    }

    fn keys(&self) -> Vec<String> {
        let keys = self.nodes.iter().filter_map(|node| node.key.clone());
        keys.map(|span| self.text[span].to_string()).collect()
    }
}
