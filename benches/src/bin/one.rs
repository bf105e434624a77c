//! Runs pieces of work by name and says how long they took: what `compare.py` talks to.
//!
//! ```text
//! one [--pictures RGB GREY WIDTH HEIGHT] list     every name and its meaning
//! one [--pictures RGB GREY WIDTH HEIGHT]          reads lines "NAME COUNT" and answers each with a line of JSON:
//!                                                 nanoseconds a call of this thread's processor time and of the
//!                                                 clock, the sum of the calls' results, or "skipped" with the reason
//! ```

use hearsight_benches::{Failure, Inputs, KERNELS, Kernel, Work};
use rustix::time::{ClockId, clock_gettime};
use std::collections::BTreeMap;
use std::io::{BufRead, Write};

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (inputs, rest) = match words.as_slice() {
        ["--pictures", rgb, grey, width, height, rest @ ..] => {
            let (rgb, grey) = (std::fs::read(rgb)?, std::fs::read(grey)?);
            (
                Inputs::from_bytes(&rgb, &grey, width.parse()?, height.parse()?)?,
                rest,
            )
        }
        rest => (Inputs::synthetic(), rest),
    };
    match rest {
        [] => answer(&inputs),
        ["list"] => {
            for kernel in KERNELS {
                println!("{:<18} {}", kernel.name, kernel.meaning);
            }
            Ok(())
        }
        other => {
            Err(format!("unknown arguments {other:?}; without any, lines \"NAME COUNT\" are read").into())
        }
    }
}

fn answer(inputs: &Inputs) -> Result<(), Failure> {
    let mut ready: BTreeMap<String, Result<Work, String>> = BTreeMap::new();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let (name, count) = line.split_once(' ').ok_or("a line must be \"NAME COUNT\"")?;
        let count: u32 = count.trim().parse()?;
        let work = ready.entry(name.to_owned()).or_insert_with(|| {
            let kernel = Kernel::named(name).ok_or_else(|| format!("there is no work {name}"))?;
            kernel.prepare(inputs).map_err(|failure| failure.to_string())
        });
        match work {
            Ok(work) => println!("{}", measure(work, count)),
            Err(reason) => println!("{{\"skipped\": {reason:?}}}"),
        }
        std::io::stdout().flush()?;
    }
    Ok(())
}

fn measure(work: &mut Work, count: u32) -> String {
    let clocks = || [ClockId::ThreadCPUTime, ClockId::Monotonic].map(nanoseconds);
    let begun = clocks();
    let result: f64 = (0..count).map(|_| std::hint::black_box(work())).sum();
    let ended = clocks();
    let each = |clock: usize| (ended[clock] - begun[clock]) / f64::from(count.max(1));
    format!(
        "{{\"cpu_ns\": {:.1}, \"wall_ns\": {:.1}, \"result\": {result:?}}}",
        each(0),
        each(1)
    )
}

fn nanoseconds(clock: ClockId) -> f64 {
    let time = clock_gettime(clock);
    time.tv_sec as f64 * 1e9 + time.tv_nsec as f64
}
