//! Flight code: it answers as the reference does, to the last bit, under strict compilers and on other processors.

use super::*;
use crate::support::tools::installed;
use std::process::Command;

pub const STRICT: [&str; 7] = [
    "-Wall",
    "-Wextra",
    "-pedantic",
    "-Wconversion",
    "-Werror",
    "-O2",
    "-ffp-contract=off",
];

/// A folder with the flight code of a design or scenario, and the name of its files.
pub struct Flight {
    pub folder: TempDir,
    pub name: String,
}

impl Flight {
    pub fn of(file: &Path, more: &[&str]) -> Self {
        let folder = folder();
        let run = command()
            .args(["export", word(file), "--format", "c99", "-o"])
            .arg(folder.path())
            .args(more)
            .output();
        let run = Run::new(run.expect("the command runs"));
        assert!(matches!(run.status, Some(0 | 2)), "{run:#?}");
        let names = names_in(folder.path());
        let test = names.iter().find_map(|name| name.strip_suffix("_test.c"));
        let name = test.expect("a test").to_string();
        for file in &names {
            let text = text(&folder.path().join(file));
            for unfilled in ["@name@", "@NAME@", "@about_file@", "@words@", "@inputs@"] {
                assert!(!text.contains(unfilled), "{file}: {unfilled}");
            }
        }
        Flight { folder, name }
    }

    pub fn path(&self, ending: &str) -> PathBuf {
        self.folder.path().join(format!("{}{ending}", self.name))
    }

    /// Compiles the self-test; the program.
    fn build(&self, compiler: &str, options: &[&str]) -> PathBuf {
        let program = self.path(".out");
        let run = Command::new(compiler)
            .args(options)
            .arg("-o")
            .arg(&program)
            .args([self.path("_test.c"), self.path(".c")])
            .arg("-lm")
            .output()
            .expect("the compiler runs");
        let complaint = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{compiler} {options:?}: {complaint}");
        program
    }

    /// The self-test passes, compiled strictly by every compiler that is installed.
    pub fn passes_strictly(&self) {
        for (compiler, language) in [
            ("gcc", &["-std=c99"][..]),
            ("clang", &["-std=c99"]),
            ("g++", &["-x", "c++", "-std=c++17"]),
        ] {
            if !installed(compiler) {
                continue;
            }
            let options = [language, &STRICT].concat();
            let (passes, said) = self.test(compiler, &options);
            println!("{} {compiler}: {said}", self.name);
            assert!(passes, "{} {compiler}: {said}", self.name);
        }
    }

    /// Whether the self-test passes, and what it prints.
    pub fn test(&self, compiler: &str, options: &[&str]) -> (bool, String) {
        let run = Command::new(self.build(compiler, options)).output();
        let run = run.expect("the test runs");
        let said = String::from_utf8_lossy(&run.stdout).into_owned();
        assert_eq!(run.status.success(), said.contains("PASSED"), "{said}");
        (run.status.success(), said)
    }
}

/// A design whose gains are scheduled by the box of the spacecraft, and whose threshold adapts; not proved.
pub fn scheduled_by_the_box() -> (TempDir, PathBuf) {
    let folder = folder();
    let mut file = json(xu2020_design());
    let gain = file["controller"]["gains"][0].clone();
    let anti_windup = file["certificate"]["anti_windup"][0].clone();
    let scaled = |factor: f64| -> Value {
        let rows = gain.as_array().unwrap().iter();
        let rows = rows.map(|row| {
            let row = row.as_array().unwrap().iter();
            Value::from_iter(row.map(|v| v.as_f64().unwrap() * factor))
        });
        Value::from_iter(rows)
    };
    let gains = (0..16).map(|rule| scaled(1.0 + 0.02 * f64::from(rule)));
    set(&mut file, "/controller/gains", Value::from_iter(gains));
    set(
        &mut file,
        "/certificate/anti_windup",
        vec![anti_windup; 16].into(),
    );
    set(&mut file, "/model/gains", json!("scheduled"));
    set(&mut file, "/model/mismatch", json!({ "kappa": 0.0 }));
    set(&mut file, "/model/specs/nu_min", json!(0.05));
    set(
        &mut file,
        "/model/specs/threshold_update",
        json!({ "mu": [0.2, 20.0, 0.01] }),
    );
    let path = write(folder.path(), "box.json", file.to_string());
    (folder, path)
}

fn every_controller() -> Vec<Flight> {
    let (_kept, scheduled) = scheduled_by_the_box();
    let designs = [
        xu2020_design(),
        double_integrator_design(),
        scheduled_design(),
        &scheduled,
    ];
    let scenarios = ["wu2018.json", "lei2022.json", "yang2025.json"].map(shipped);
    let files = designs
        .into_iter()
        .chain(scenarios.iter().map(|path| path.as_path()));
    files.map(|file| Flight::of(file, &[])).collect()
}

#[test]
fn the_flight_code_of_every_controller_answers_as_the_reference_does() {
    for flight in every_controller() {
        flight.passes_strictly();
    }
}

#[test]
fn the_example_of_the_flight_code_runs() {
    for file in [xu2020_design(), double_integrator_design()] {
        let flight = Flight::of(file, &[]);
        let example = flight.folder.path().join("example_main.c");
        let program = flight.path(".example");
        let run = Command::new("gcc")
            .args(["-std=c99"])
            .args(STRICT)
            .arg("-o")
            .arg(&program)
            .args([example, flight.path(".c")])
            .arg("-lm")
            .output()
            .expect("gcc runs");
        assert!(run.status.success(), "{run:?}");
        let run = Command::new(program).output().expect("the example runs");
        let said = String::from_utf8_lossy(&run.stdout).into_owned();
        assert_eq!(said.lines().count(), 10, "{said}");
        assert!(said.contains("status 0, sent 1"), "{said}");
        assert!(!said.contains("status 2"), "{said}");
    }
}

#[test]
fn a_contracting_compiler_fails_the_self_test_which_says_why() {
    let flags = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    if !flags.contains(" fma ") {
        eprintln!("SKIPPED: this processor has no fused multiply-add; contraction was not tried");
        return;
    }
    let flight = Flight::of(xu2020_design(), &[]);
    let options = ["-std=gnu99", "-O2", "-mfma", "-ffp-contract=fast"];
    let (passes, said) = flight.test("gcc", &options);
    assert!(!passes && said.contains("-ffp-contract=off"), "{said}");
}

#[test]
fn one_wrong_digit_in_the_flight_code_fails_the_self_test() {
    let flight = Flight::of(xu2020_design(), &[]);
    let source = text(&flight.path(".c"));
    for (from, to) in [
        (
            "static const double FLOOR = 0",
            "static const double FLOOR = 1",
        ),
        ("time_s <= self->time_s", "time_s < self->time_s"),
        ("error[0] < 0.0", "error[0] > 0.0"),
        (
            "(variables[index] < LOWER[index])",
            "(variables[index] < -UPPER[index])",
        ),
        ("self->sent_form = form;", "self->sent_form = 2.0 * form;"),
        (
            "self->remaining = XU2020_REPEATS",
            "self->remaining = 1U + XU2020_REPEATS",
        ),
    ] {
        assert_eq!(source.matches(from).count(), 1, "{from}");
        write(
            flight.folder.path(),
            &format!("{}.c", flight.name),
            source.replace(from, to),
        );
        let (passes, _) = flight.test("gcc", &["-std=c99", "-O1", "-ffp-contract=off"]);
        assert!(!passes, "{to}");
    }
}

/// Startup of a Cortex-M in an emulator: a table of vectors, and the library's start with semihosting.
const STARTUP: &str = "
extern unsigned int stack_top;
extern void _start(void);
static void reset(void) { *(volatile unsigned int *)0xE000ED88u |= 0xFu << 20; __asm volatile(\"dsb\\nisb\"); _start(); }
__attribute__((section(\".vectors\"), used)) static void *const vectors[2] = { &stack_top, (void *)reset };
";

const LINKER: &str = "
ENTRY(_start)
MEMORY { code (rx) : ORIGIN = 0, LENGTH = 4M  data (rwx) : ORIGIN = 0x20000000, LENGTH = 4M }
SECTIONS {
  .text : {
    KEEP(*(.vectors)) *(.text*) *(.rodata*) KEEP(*(.init)) KEEP(*(.fini))
    __preinit_array_start = .; __preinit_array_end = .;
    __init_array_start = .; KEEP(*(.init_array*)) __init_array_end = .;
    __fini_array_start = .; KEEP(*(.fini_array*)) __fini_array_end = .;
    . = ALIGN(8);
  } > code
  .ARM.exidx : { __exidx_start = .; *(.ARM.ex*) __exidx_end = .; } > code
  .data : { *(.data*) . = ALIGN(8); } > data AT > data
  .bss : { __bss_start__ = .; *(.bss*) *(COMMON) . = ALIGN(8); __bss_end__ = .; end = .; __end__ = .; } > data
  stack_top = ORIGIN(data) + LENGTH(data);
}
";

#[test]
fn emulated_processors_answer_with_the_same_bits() {
    if !installed("arm-none-eabi-gcc") || !installed("qemu-system-arm") {
        return;
    }
    on_emulated_processors(&Flight::of(xu2020_design(), &["--samples", "20000"]));
    let single = ["--samples", "20000", "--float"];
    on_emulated_processors(&Flight::of(xu2020_design(), &single));
}

/// Runs the self-test on a Cortex-M4F, whose unit of floating point has single precision only, and on a Cortex-M7.
fn on_emulated_processors(flight: &Flight) {
    let startup = write(flight.folder.path(), "startup.c", STARTUP);
    let script = write(flight.folder.path(), "board.ld", LINKER);
    for (board, options) in [
        (
            "mps2-an386",
            &["-mcpu=cortex-m4", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"],
        ),
        (
            "mps2-an500",
            &["-mcpu=cortex-m7", "-mfloat-abi=hard", "-mfpu=fpv5-d16"],
        ),
    ] {
        let program = flight.path(".elf");
        let run = Command::new("arm-none-eabi-gcc")
            .args([
                "-mthumb",
                "-O2",
                "-std=c99",
                "-ffp-contract=off",
                "-fstack-usage",
            ])
            .args(options)
            .args(["--specs=rdimon.specs", "-T", word(&script), "-o"])
            .arg(&program)
            .args([&startup, &flight.path("_test.c"), &flight.path(".c")])
            .args(["-lm"])
            .current_dir(flight.folder.path())
            .output()
            .expect("the compiler runs");
        let complaint = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{board}: {complaint}");
        let run = Command::new("timeout")
            .args([
                "120",
                "qemu-system-arm",
                "-M",
                board,
                "-nographic",
                "-semihosting",
            ])
            .args(["-kernel", word(&program)])
            .output()
            .expect("the emulator runs");
        let said = String::from_utf8_lossy(&run.stdout);
        assert!(said.contains("PASSED: 20000 samples"), "{board}: {run:?}");
        println!("{board}: {}", said.trim());
        sizes(flight, options);
    }
}

/// Prints the sizes of the code and of the stack.
fn sizes(flight: &Flight, options: &[&str]) {
    let object = flight.path(".o");
    let run = Command::new("arm-none-eabi-gcc")
        .args([
            "-mthumb",
            "-Os",
            "-std=c99",
            "-ffp-contract=off",
            "-fstack-usage",
            "-c",
            "-o",
        ])
        .arg(&object)
        .args(options)
        .arg(flight.path(".c"))
        .output()
        .expect("the compiler runs");
    assert!(run.status.success());
    let run = Command::new("arm-none-eabi-size").arg(&object).output();
    let said = String::from_utf8_lossy(&run.expect("size runs").stdout).into_owned();
    let frames = text(&flight.path(".su"));
    let frames = frames
        .lines()
        .filter_map(|line| line.split('\t').nth(1)?.parse::<u32>().ok());
    println!("{said}stack frames, sum {} bytes", frames.sum::<u32>());
}

/// Rules of MISRA C 2012 that are not required.
const ADVISORY: [&str; 4] = ["2.5", "8.7", "8.9", "15.5"];

#[test]
fn the_flight_code_keeps_the_required_rules_of_misra_c() {
    if !installed("cppcheck") {
        return;
    }
    for flight in every_controller() {
        let run = Command::new("cppcheck")
            .args([
                "--addon=misra",
                "--std=c99",
                "--enable=style",
                "-DDBL_MANT_DIG=53",
            ])
            .args(["-DDBL_EPSILON=2.220446049250313e-16", "-DHUGE_VAL=1e308"])
            .arg(flight.path(".c"))
            .output()
            .expect("cppcheck runs");
        let said = String::from_utf8_lossy(&run.stderr).into_owned();
        let rules = said.split("misra-c2012-").skip(1);
        let rules: Vec<&str> = rules.filter_map(|rest| rest.split(']').next()).collect();
        // Without a finding it was not analysed: functions return early where there is nothing to do.
        assert!(rules.contains(&"15.5"), "{said}");
        for rule in rules {
            assert!(
                ADVISORY.contains(&rule),
                "{}: rule {rule}: {said}",
                flight.name
            );
        }
    }
}

#[test]
fn cmake_and_pkg_config_find_the_installed_flight_code() {
    if !installed("cmake") {
        return;
    }
    let flight = Flight::of(xu2020_design(), &[]);
    let at = |name: &str| flight.folder.path().join(name);
    let (build, prefix) = (at("build"), at("prefix"));
    let run = |program: &str, arguments: &[&str]| {
        let run = Command::new(program)
            .args(arguments)
            .output()
            .expect(program);
        assert!(run.status.success(), "{program} {arguments:?}: {run:?}");
        String::from_utf8_lossy(&run.stdout).into_owned()
    };
    let source = word(flight.folder.path());
    let placed = format!("-DCMAKE_INSTALL_PREFIX={}", prefix.display());
    run("cmake", &["-S", source, "-B", word(&build), &placed]);
    run("cmake", &["--build", word(&build), "--target", "install"]);
    run("ctest", &["--test-dir", word(&build)]);
    let consumer = folder();
    let project = format!(
        "cmake_minimum_required(VERSION 3.10)\nproject(consumer C)\nfind_package({0} REQUIRED)\n\
         add_executable(consumer {1})\ntarget_link_libraries(consumer PRIVATE {0})\n",
        flight.name,
        at("example_main.c").display()
    );
    write(consumer.path(), "CMakeLists.txt", project);
    let built = consumer.path().join("build");
    let found = format!("-DCMAKE_PREFIX_PATH={}", prefix.display());
    run(
        "cmake",
        &["-S", word(consumer.path()), "-B", word(&built), &found],
    );
    run("cmake", &["--build", word(&built)]);
    let descriptions = ["lib", "lib64", "lib/x86_64-linux-gnu"].map(|lib| {
        let name = format!("{lib}/pkgconfig/{}.pc", flight.name);
        prefix.join(name)
    });
    let described = descriptions.iter().find(|path| path.exists());
    let described = text(described.expect("a description for pkg-config"));
    assert!(
        described.contains(&format!("prefix={}", prefix.display())),
        "{described}"
    );
    assert!(!described.contains('@'), "{described}");
}

#[test]
fn flight_code_that_cannot_be_written_is_refused_in_one_sentence() {
    let folder = folder();
    let out = folder.path().join("out");
    let model = shipped("xu2020.json");
    let closed_loop = shipped("xu2020-closed-loop.json");
    let published = shipped("xu2020-published.json");
    let cases = [
        (
            model.as_path(),
            "this is a model file; c99 is for design and scenario files",
        ),
        (&closed_loop, "flies the controller of a design file"),
        (&published, "there is no C source of this controller"),
        (
            run_folder(),
            "this is a trajectory; c99 is for design files",
        ),
    ];
    for (file, expected) in cases {
        let message = export(file, "c99", Some(&out)).refusal();
        assert!(message.contains(expected), "{message}");
        assert!(!out.exists(), "{message}");
    }
    let message = export(xu2020_design(), "c99", None).refusal();
    assert!(
        message.contains("--output") && message.contains("folder"),
        "{message}"
    );
    let other = write(folder.path(), "README.txt", "mine");
    let message = export(xu2020_design(), "c99", Some(folder.path())).refusal();
    assert!(
        message.contains("README.txt") && message.contains("--force"),
        "{message}"
    );
    assert_eq!(text(&other), "mine");
    for more in [&["--samples", "10"][..], &["--form", "full"]] {
        let run = command()
            .args([
                "export",
                word(xu2020_design()),
                "--format",
                "c99",
                "-o",
                word(&out),
            ])
            .args(more)
            .output();
        Run::new(run.expect("the command runs")).refusal();
    }
    // What it wrote itself it replaces.
    export(xu2020_design(), "c99", Some(&out)).ends_with(0);
    export(xu2020_design(), "c99", Some(&out)).ends_with(0);
}
