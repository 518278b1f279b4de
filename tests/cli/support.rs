//! Running the program in a directory of its own.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::OnceLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

/// The program under test.
pub const PROGRAM: &str = env!("CARGO_BIN_EXE_fric-cli");

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The text of the example's robot file.
pub fn example_robot() -> String {
    fs::read_to_string(root().join("examples/mini-ipanema.toml")).unwrap()
}

/// The same robot with a cycle of 10 ms, so that a whole run is short.
pub fn slow_robot() -> String {
    example_robot().replacen("cycle_s = 0.001", "cycle_s = 0.01", 1)
}

/// The program in a directory.
pub fn command(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command.current_dir(directory).args(arguments);
    command
}

/// What a run of the program gave.
#[derive(Debug)]
pub struct Run {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    pub fn new(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    /// Done, and nothing to remark.
    #[track_caller]
    pub fn succeeds(self) -> Self {
        assert_eq!((self.code, self.stderr.as_str()), (Some(0), ""), "{self:#?}");
        self
    }

    /// Done, with a warning that says all of `words`.
    #[track_caller]
    pub fn warns(self, words: &[&str]) -> Self {
        assert_eq!(self.code, Some(0), "{self:#?}");
        assert!(self.stderr.lines().all(|line| line.starts_with("warning: ")), "{self:#?}");
        assert!(self.stderr.lines().any(|line| words.iter().all(|word| line.contains(word))), "{words:?} {self:#?}");
        self
    }

    /// Failed with this code and nothing on stdout; the cause and the advice under it say all of `words`.
    #[track_caller]
    pub fn fails(self, code: i32, words: &[&str]) -> Self {
        assert_eq!((self.code, self.stdout.as_str()), (Some(code), ""), "{self:#?}");
        let errors = self.stderr.lines().filter(|line| line.starts_with("error: ")).count();
        assert_eq!(errors, 1, "{self:#?}");
        let cause = self.stderr.lines().find(|line| !line.starts_with("warning: ")).unwrap_or_default();
        assert!(cause.starts_with("error: "), "{self:#?}");
        let sentence: String = self.stderr.lines().filter(|line| !line.starts_with("warning: ")).collect();
        for word in words {
            assert!(sentence.contains(word), "no {word:?} in {self:#?}");
        }
        for noise in ["panicked", "RUST_BACKTRACE", ".tmp", ".part", "Os {", "Some(", "\u{1b}"] {
            assert!(!self.stderr.contains(noise), "{self:#?}");
        }
        self
    }

    /// The line under the cause.
    #[track_caller]
    pub fn advises(self, words: &[&str]) -> Self {
        let advice = self.stderr.lines().skip_while(|line| !line.starts_with("error: ")).nth(1).unwrap_or_default();
        assert!(advice.starts_with("  "), "{self:#?}");
        for word in words {
            assert!(advice.contains(word), "no {word:?} in {self:#?}");
        }
        self
    }
}

/// What a JSON says, without where it comes from: time and command differ from run to run.
pub fn result_of(json: &[u8]) -> Value {
    let mut result: Value = serde_json::from_slice(json).unwrap();
    if let Some(origin) = result.as_object_mut().unwrap().remove("provenance") {
        assert_eq!(origin["program"], "fric");
    }
    result
}

/// A text in one line, as it was before it was wrapped; columns stand one space apart.
pub fn unwrapped(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// How long a test waits for what has to happen before it fails.
const PATIENCE: Duration = Duration::from_secs(120);

/// The program while it runs, its stdout and stderr kept; a test that ends before it does, by failing, kills it.
pub struct Running(Child);

impl Running {
    /// Sends a signal.
    #[cfg(unix)]
    pub fn signal(&self, signal: nix::sys::signal::Signal) {
        let process = nix::unistd::Pid::from_raw(self.0.id().try_into().unwrap());
        nix::sys::signal::kill(process, signal).unwrap();
    }

    /// Waits for the first byte on stdout.
    #[cfg(unix)]
    pub fn prints(&mut self) {
        self.0.stdout.as_mut().unwrap().read_exact(&mut [0]).unwrap();
    }

    #[cfg(unix)]
    pub fn is_running(&mut self) -> bool {
        self.0.try_wait().unwrap().is_none()
    }

    /// Closes the reading end of stdout.
    pub fn close_stdout(&mut self) {
        drop(self.0.stdout.take());
    }

    /// Waits for something to happen while the program runs.
    #[track_caller]
    pub fn wait_until(&mut self, happened: impl Fn() -> bool) {
        let start = Instant::now();
        while !happened() {
            assert!(self.0.try_wait().unwrap().is_none(), "ended too early");
            assert!(start.elapsed() < PATIENCE, "nothing after {PATIENCE:?}");
            sleep(Duration::from_millis(2));
        }
    }

    /// Waits for the end; what is printed until then has to fit into the pipes.
    #[track_caller]
    pub fn end(mut self) -> Output {
        let start = Instant::now();
        let status = loop {
            if let Some(status) = self.0.try_wait().unwrap() {
                break status;
            }
            assert!(start.elapsed() < PATIENCE, "still running after {PATIENCE:?}");
            sleep(Duration::from_millis(2));
        };
        let (mut stdout, mut stderr) = (Vec::new(), Vec::new());
        if let Some(pipe) = &mut self.0.stdout {
            pipe.read_to_end(&mut stdout).unwrap();
        }
        self.0.stderr.as_mut().unwrap().read_to_end(&mut stderr).unwrap();
        Output { status, stdout, stderr }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // Neither does anything to a process that has ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A directory to run the program in, gone at the end.
pub struct Place {
    directory: TempDir,
}

impl Place {
    /// An empty one.
    pub fn empty() -> Self {
        Self { directory: tempfile::tempdir().unwrap() }
    }

    /// One with a short log of the example robot, `log.mcap`, and its robot file, `robot.toml`.
    pub fn with_log() -> Self {
        let place = Self::empty();
        place.write("log.mcap", short_log());
        place.write("robot.toml", example_robot());
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// A result, see [`result_of`].
    pub fn json(&self, name: &str) -> Value {
        result_of(&self.read(name))
    }

    /// The program's command line, to be changed before it runs.
    pub fn command(&self, arguments: &[&str]) -> Command {
        command(self.directory.path(), arguments)
    }

    pub fn run(&self, arguments: &[&str]) -> Run {
        Run::new(self.command(arguments).output().unwrap())
    }

    /// Starts the program and leaves it running.
    pub fn start(&self, arguments: &[&str]) -> Running {
        Running(self.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap())
    }

    /// Runs the program on a command line that has to leave everything as it was.
    pub fn run_in_vain(&self, arguments: &[&str]) -> Run {
        let before = self.content();
        let run = self.run(arguments);
        let after = self.content();
        assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>(), "{run:#?}");
        assert!(before == after, "a file is no longer what it was: {run:#?}");
        run
    }

    /// Names of all that is there.
    pub fn names(&self) -> Vec<String> {
        self.content().into_keys().collect()
    }

    /// Everything there by name; directories and broken links have no content.
    fn content(&self) -> BTreeMap<String, Option<Vec<u8>>> {
        let entries = fs::read_dir(self.directory.path()).unwrap().map(Result::unwrap);
        entries.map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).ok())).collect()
    }
}

/// The bytes of a log of the example robot, 0.4 s, with noise, reference, pose and wrench; made once.
pub fn short_log() -> &'static [u8] {
    static LOG: OnceLock<Vec<u8>> = OnceLock::new();
    LOG.get_or_init(|| {
        let place = Place::empty();
        place.write("robot.toml", example_robot());
        place
            .run(&["simulate", "--model", "robot.toml", "-o", "log.mcap", "--duration", "0.4", "--seed", "3"])
            .succeeds();
        place.read("log.mcap")
    })
}

/// Deterministic numbers (xorshift).
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 % bound as u64).unwrap()
    }
}

/// Root mean square; NaN for nothing.
#[expect(clippy::cast_precision_loss, reason = "a count of samples")]
pub fn rms(deviations: impl IntoIterator<Item = f64>) -> f64 {
    let (mut squares, mut count) = (0.0, 0_usize);
    for deviation in deviations {
        squares += deviation * deviation;
        count += 1;
    }
    (squares / count as f64).sqrt()
}

/// Equal but for the order of summation.
#[track_caller]
pub fn assert_close(one: f64, other: f64) {
    assert!((one - other).abs() <= 1e-9 * one.abs().max(other.abs()), "{one} is not {other}");
}
