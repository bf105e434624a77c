//! Judges a file of tracks by one of truth, as often as asked: what `compare_judge.py` talks to.
//!
//! ```text
//! judge TRUTH TRACKS COUNT     a line of JSON for each time: nanoseconds of this thread's processor time from the files
//!                              to the values of CLEAR MOT, identity and HOTA, and three of these
//! ```

use hearsight_benches::Failure;
use hearsight_eval::metrics::Judge;
use hearsight_eval::metrics::clear::Clear;
use hearsight_eval::metrics::hota::Hota;
use hearsight_eval::metrics::identity::Identity;
use hearsight_eval::read::read;
use hearsight_eval::{Options, Side, pair};
use rustix::time::{ClockId, clock_gettime};
use std::path::Path;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [truth, tracks, count] = arguments.as_slice() else {
        return Err("three arguments are needed: TRUTH TRACKS COUNT".into());
    };
    for _ in 0..count.parse::<u32>()? {
        let begun = nanoseconds();
        let [mota, idf1, hota] = judge(Path::new(truth), Path::new(tracks))?;
        let spent = nanoseconds() - begun;
        println!("{{\"cpu_ns\": {spent:.0}, \"mota\": {mota:?}, \"idf1\": {idf1:?}, \"HOTA\": {hota:?}}}");
    }
    Ok(())
}

fn judge(truth: &Path, tracks: &Path) -> Result<[f64; 3], Failure> {
    let (truth, tracks) = (read(truth, Side::Truth, None)?, read(tracks, Side::Tracks, None)?);
    let cases = pair("", &truth, &tracks, &Options::default())?.cases;
    let families: [(&dyn Judge, &str); 3] = [(&Clear, "mota"), (&Identity, "idf1"), (&Hota, "HOTA")];
    let mut values = [0.0; 3];
    for (value, (family, name)) in values.iter_mut().zip(families) {
        let judged = family.judge(&cases)?.ok_or("there is nothing to judge")?;
        let place = family.metrics().iter().position(|metric| metric.name == name);
        *value = place
            .and_then(|place| judged.overall[place])
            .ok_or("a value is not defined")?;
    }
    Ok(values)
}

fn nanoseconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 * 1e9 + time.tv_nsec as f64
}
