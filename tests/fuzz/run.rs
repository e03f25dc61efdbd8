//! Reads cases one after the other and measures their cost.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::allocator::{Memory, memory_of};
use super::readers::{Kind, Outcome, kinds};

/// Number of cases over all kinds of files, unless ABBE_FUZZ_CASES sets another.
const CASES: usize = 40_000;
/// A case that takes longer counts as hanging. Most take a thousandth of a second.
const MAX_TIME: Duration = Duration::from_secs(10);
/// The most memory that a file of some kilobytes may take.
pub const MAX_MEMORY: usize = 1 << 30;

/// The case that is being read, and its start.
static CURRENT_CASE: Mutex<Option<(String, Instant)>> = Mutex::new(None);
/// Memory is counted for only one test at a time.
static MEMORY_LOCK: Mutex<()> = Mutex::new(());

pub fn lock_memory() -> MutexGuard<'static, ()> {
    MEMORY_LOCK.lock().unwrap_or_else(PoisonError::into_inner)
}

fn now(of: Option<(String, Instant)>) {
    *CURRENT_CASE.lock().unwrap_or_else(PoisonError::into_inner) = of;
}

/// Ends the program with the name of a case that hangs, because nothing else would end it.
fn watch() {
    thread::spawn(|| {
        loop {
            thread::sleep(Duration::from_secs(1));
            let case = CURRENT_CASE.lock().unwrap_or_else(PoisonError::into_inner).clone();
            if let Some((case, since)) = case.filter(|(_, since)| since.elapsed() > MAX_TIME) {
                eprintln!("{case} has taken {:?}", since.elapsed());
                std::process::exit(1);
            }
        }
    });
}

/// The result of reading one file, with its cost.
pub struct Cost {
    pub outcome: Outcome,
    pub time: Duration,
    pub memory: Memory,
}

/// Reads one file, and panics with the name of the case if the reader panics.
pub fn read(kind: &Kind, bytes: &[u8], way: u64, case: &str) -> Cost {
    let start = Instant::now();
    now(Some((case.to_owned(), start)));
    let (outcome, memory) = memory_of(|| catch_unwind(AssertUnwindSafe(|| kind.read(bytes, way))));
    now(None);
    let outcome = outcome.unwrap_or_else(|_| panic!("{case} made the reader panic: {:?}", head(bytes)));
    let most = memory.largest.max(memory.peak);
    assert!(most <= MAX_MEMORY, "{case} of {} bytes took {most} bytes: {:?}", bytes.len(), head(bytes));
    Cost { outcome, time: start.elapsed(), memory }
}

fn head(bytes: &[u8]) -> String {
    String::from_utf8_lossy(&bytes[..bytes.len().min(2000)]).into_owned()
}

#[test]
fn the_files_that_are_damaged_are_whole() {
    let _alone = lock_memory();
    for kind in kinds() {
        for (number, bytes) in kind.corpus().iter().enumerate() {
            let readable = (0..kind.ways()).any(|way| read(&kind, bytes, way, "corpus").outcome.is_ok());
            assert!(readable, "{} {number}: {:?}", kind.name, kind.read(bytes, 0));
        }
    }
}

#[test]
fn no_damage_to_a_file_stops_the_program_that_reads_it() {
    let _alone = lock_memory();
    let cases = std::env::var("ABBE_FUZZ_CASES").ok().map_or(CASES, |cases| cases.parse().expect("a whole number"));
    let mut kinds = kinds();
    let shares: usize = kinds.iter().map(|kind| kind.share).sum();
    if let Ok(only) = std::env::var("ABBE_FUZZ_KINDS") {
        kinds.retain(|kind| only.split(',').any(|name| name == kind.name));
    }
    watch();
    for kind in &kinds {
        let (mut accepted, mut refused, mut memory) = (0, 0, Memory::default());
        let mut slowest = (Duration::ZERO, 0);
        let (start, all) = (Instant::now(), (cases * kind.share).div_ceil(shares) as u64);
        for number in 0..all {
            let cost = read(kind, &kind.case(number), number, &format!("{} case {number}", kind.name));
            *(if cost.outcome.is_ok() { &mut accepted } else { &mut refused }) += 1;
            slowest = slowest.max((cost.time, number));
            memory = memory.max(cost.memory);
        }
        println!(
            "{:4} {all:7} cases in {:6.1} s: {accepted} read, {refused} refused; slowest {:.3} s (case {}); \
             largest allocation {:.1} MB, at most {:.1} MB held",
            kind.name,
            start.elapsed().as_secs_f64(),
            slowest.0.as_secs_f64(),
            slowest.1,
            memory.largest as f64 / 1e6,
            memory.peak as f64 / 1e6,
        );
        assert!(accepted > 0 && refused > 0, "{}: {accepted} read, {refused} refused", kind.name);
        assert!(slowest.0 < MAX_TIME, "{} case {} took {:?}", kind.name, slowest.1, slowest.0);
    }
}
