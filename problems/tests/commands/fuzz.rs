//! Mutated scene, control, grid and journal files: each is accepted or refused with an error, none panics or hangs.
//!
//! `FUZZ_INPUTS=100000 cargo test --release -p problems --test commands fuzz -- --nocapture` runs 100 000 inputs;
//! without the variable a few thousand. Inputs are a function of their number alone. Nothing is solved: reading,
//! conversion, validation, the memory estimate, and for small scenes the discrete problem with its admissible set.

use contact::communication::InProcess;
use contact::error::SceneError;
use contact::memory;
use contact::scene::BodyScene;
use contact::solvers::Wanted;
use nonsmooth::Journal;
use problems::commands::{Layout, parse_controls};
use scene_file::{Case, SceneFile};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use testset::kit::{self, Random};

/// Inputs of an ordinary test run.
const FEW: u64 = 3000;
/// A scene with more contact nodes or controls than this is not made discrete.
const SMALL: usize = 400;
/// Longest time for one input.
const LONGEST: Duration = Duration::from_secs(5);

/// Numbers and words that parsers and checks get wrong.
const TOKENS: [&str; 40] = [
    "0",
    "-0.0",
    "-1",
    "1",
    "1e308",
    "-1e308",
    "1e400",
    "1e-320",
    "nan",
    "-nan",
    "inf",
    "-inf",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551616",
    "0x10",
    "1_000",
    "true",
    "null",
    "\"\"",
    "\"x1-min\"",
    "\"bottom\"",
    "[]",
    "[[]]",
    "[1, 2, 3]",
    "{}",
    "{ form = \"plane\" }",
    "'",
    "\"",
    "\u{0}",
    "\u{feff}",
    "α",
    "𝓕",
    "\r",
    "=",
    ".",
    "#",
    "2026-01-01",
    "[output]",
    "../../x",
];

/// Splits into words, numbers, quoted names and single other characters.
fn tokens(text: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let mut inside = false;
    for character in text.chars() {
        let part = character.is_alphanumeric() || "._-+".contains(character);
        match tokens.last_mut() {
            Some(last) if part && inside => last.push(character),
            _ => tokens.push(character.to_string()),
        }
        inside = part;
    }
    tokens
}

fn mutate_tokens(text: &str, random: &mut Random) -> String {
    let mut tokens = tokens(text);
    for _ in 0..=random.below(3) {
        if tokens.is_empty() {
            break;
        }
        let at = random.below(tokens.len());
        match random.below(5) {
            0 => tokens[at] = TOKENS[random.below(TOKENS.len())].to_owned(),
            1 => drop(tokens.remove(at)),
            2 => tokens.insert(at, TOKENS[random.below(TOKENS.len())].to_owned()),
            3 => tokens[at] = tokens[random.below(tokens.len())].clone(),
            _ => {
                // Another number of the same kind: most such files stay syntactically right.
                let numbers: Vec<usize> = (0..tokens.len()).filter(|&i| tokens[i].parse::<f64>().is_ok()).collect();
                if !numbers.is_empty() {
                    let exponent = random.below(41) as i32 - 20;
                    let integer = random.below(3) == 0;
                    let sign = if random.below(4) == 0 { -1.0 } else { 1.0 };
                    let value = sign * (1 + random.below(999)) as f64 * 10f64.powi(exponent);
                    tokens[numbers[random.below(numbers.len())]] =
                        if integer { random.below(500).to_string() } else { format!("{value:e}") };
                }
            }
        }
    }
    tokens.concat()
}

fn mutate_lines(text: &str, random: &mut Random) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    if !lines.is_empty() {
        let (at, other) = (random.below(lines.len()), random.below(lines.len()));
        match random.below(3) {
            0 => drop(lines.remove(at)),
            1 => lines.insert(other, lines[at]),
            _ => lines.swap(at, other),
        }
    }
    lines.join("\n")
}

fn mutate_bytes(text: &str, random: &mut Random) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=random.below(4) {
        if bytes.is_empty() {
            break;
        }
        let at = random.below(bytes.len());
        match random.below(5) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.below(256) as u8,
            2 => drop(bytes.remove(at)),
            3 => bytes.insert(at, random.below(256) as u8),
            _ => bytes.truncate(at),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn mutate(text: &str, random: &mut Random) -> String {
    match random.below(8) {
        0..=3 => mutate_tokens(text, random),
        4 | 5 => mutate_bytes(text, random),
        6 => mutate_lines(text, random),
        _ => {
            let once = mutate_lines(text, random);
            mutate_tokens(&once, random)
        }
    }
}

/// What a valid input must satisfy, as far as that is cheap.
fn scene(text: &str, folder: &Path) -> Result<(), SceneError> {
    let file = SceneFile::parse(text, "input.toml")?;
    assert_eq!(SceneFile::parse(&file.print()?, "printed").as_ref().ok(), Some(&file), "the printed file differs");
    let case = Case::new(&file, folder)?;
    case.plans(Wanted::States).try_for_each(|plan| memory::check(&plan, &InProcess))?;
    let bricks = case.scene.bodies.iter().filter_map(BodyScene::block).map(|block| block.bricks);
    let is_small = |[n1, n2, n3]: [usize; 3]| (n1 + 1) * (n2 + 1) <= SMALL && n3 <= 40;
    if bricks.into_iter().all(is_small) && case.scene.control_count() <= SMALL {
        let (_, _, problems) = case.cost()?;
        let problem = &problems[0];
        let start = case.start.unwrap_or_else(|| case.scene.start());
        problem.admissible.check(&nonsmooth::Vector::from_vec(start.clone()))?;
        // Inverted elements are refused later, with an error of the contact problem.
        let _refused_or_not = problem.positions(&start);
    }
    Ok(())
}

struct Corpus {
    scenes: Vec<String>,
    controls: String,
    grid: String,
    journal: String,
    folder: PathBuf,
}

/// A journal with an answer, a failure and an answer that has all kinds of numbers.
fn journal() -> String {
    let entry = |number: usize, target: &str, answer: &str| {
        format!(
            "{{\"evaluation\":{number},\"point\":[100.0,99.5],\"accuracy\":1e-12,\"target\":{target},\
             \"linearization\":{{\"accuracy\":1e-4,\"below\":\"inf\"}},\"restarted_from\":null,\"seconds\":0.5,\"answer\":{answer}}}\n"
        )
    };
    let evaluated = |value: &str| {
        format!(
            "{{\"evaluated\":{{\"value\":{value},\"subgradient\":[1.5,-2e-3],\"error_bound\":0.0,\"no_descent\":false,\
             \"restart_data\":true,\"linearization\":{{\"failed\":\"singular\"}},\"work\":31}}}}"
        )
    };
    let text = "{\"journal\":3,\"identity\":\"a scene\",\"dimension\":2}\n".to_owned()
        + &entry(1, "null", &evaluated("4e17"))
        + &entry(2, "3e17", "{\"failed\":\"an element is inverted\"}")
        + &entry(3, "3e17", &evaluated("\"-inf\""));
    assert_eq!(Journal::parse(text.as_bytes(), Path::new("journal")).unwrap().unwrap().entries.len(), 3);
    text
}

impl Corpus {
    /// The inputs; files go to the folder `scratch`.
    fn new(scratch: &Path) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        let names =
            ["signorini", "hertz", "signorini_frictionless", "flat_punch", "tangential", "thin_layer", "just_touching"];
        let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
        let mut scenes: Vec<String> = names.iter().map(|name| read(&format!("{name}.toml"))).collect();
        let printed = scenes.iter().map(|text| SceneFile::parse(text, "x").unwrap().print().unwrap());
        scenes.extend(printed.collect::<Vec<_>>());
        let heights: Vec<String> = (0..36).map(|i| format!("{}", 100.0 + 0.125 * f64::from(i))).collect();
        std::fs::copy(folder.join("flat_punch.csv"), scratch.join("flat_punch.csv")).unwrap();
        let rows: Vec<String> = heights.chunks(9).map(|row| format!("[{}]", row.join(", "))).collect();
        let controls = format!("[{}]", rows.join(", "));
        Self { scenes, controls, grid: read("flat_punch.csv"), journal: journal(), folder: scratch.to_path_buf() }
    }

    /// Input `number` and whether it was accepted.
    fn try_input(&self, number: u64) -> (String, std::thread::Result<bool>) {
        let mut random = Random(number);
        match random.below(16) {
            0 | 1 => {
                let text = mutate(&self.controls, &mut random);
                let result = catch_unwind(|| parse_controls(&text, "controls.json", Layout::Grid([4, 9])).is_ok());
                (text, result)
            }
            2 => {
                let text = mutate(&self.grid, &mut random);
                let file = self.folder.join("grid.csv");
                std::fs::write(&file, &text).unwrap();
                let with_grid = self.scenes[3].replace("flat_punch.csv", "grid.csv");
                (text, catch_unwind(AssertUnwindSafe(|| scene(&with_grid, &self.folder).is_ok())))
            }
            3 => {
                let text = mutate(&self.journal, &mut random);
                let result = catch_unwind(|| Journal::parse(text.as_bytes(), Path::new("journal")).is_ok());
                (text, result)
            }
            _ => {
                let text = mutate(&self.scenes[random.below(self.scenes.len())], &mut random);
                let result = catch_unwind(AssertUnwindSafe(|| scene(&text, &self.folder).is_ok()));
                (text, result)
            }
        }
    }
}

#[test]
fn mutated_files_are_accepted_or_refused() {
    let inputs = std::env::var("FUZZ_INPUTS").map_or(FEW, |count| count.parse().expect("FUZZ_INPUTS: a number"));
    let scratch = kit::scratch();
    let corpus = Corpus::new(scratch.path());
    for text in &corpus.scenes {
        assert!(scene(text, &corpus.folder).is_ok(), "an input is wrong before it is mutated");
    }
    let (mut accepted, mut slowest) = (0, Duration::ZERO);
    for number in 0..inputs {
        let clock = Instant::now();
        let (text, result) = corpus.try_input(number);
        let time = clock.elapsed();
        slowest = slowest.max(time);
        assert!(time < LONGEST, "input {number} took {time:?}:\n{text}");
        match result {
            Ok(valid) => accepted += u64::from(valid),
            Err(_) => panic!("input {number} panicked:\n{text}"),
        }
    }
    println!("{inputs} inputs: {accepted} accepted, {} refused, slowest {slowest:?}", inputs - accepted);
    // Mutations that leave nothing valid, or break nothing, would test little.
    assert!(accepted > inputs / 50 && accepted < inputs / 2, "{accepted} of {inputs} accepted");
}
