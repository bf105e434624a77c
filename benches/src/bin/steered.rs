//! Scores a grid by recorded frames and says how long it took: what `steered.py` compares with.
//!
//! ```text
//! steered SPECIFICATION FRAMES ROUNDS
//! ```
//! SPECIFICATION is text: a line "rate RATE length SAMPLES", a line "bounds X Y Z X Y Z step STEP", then a line
//! "x y z" a microphone. FRAMES is 32-bit little-endian floats: frames x microphones x samples. The answer is one
//! line of JSON: nanoseconds a frame of this thread's processor time for transforms, curves, table, particles and
//! search, and for each frame the best point of the grid and of the search.

use hearsight_audio::spectrum::{Spectra, SpectrumAnalyzer, Window, transform_length};
use hearsight_audio::steered_response::{Bounds, Search, SearchSettings, SteeredResponse, SteeredSettings};
use hearsight_benches::Failure;
use hearsight_core::WorldPoint;
use hearsight_core::microphones::MicrophoneArray;
use rustix::time::{ClockId, clock_gettime};

struct Specification {
    rate_hz: u32,
    length: usize,
    bounds: Bounds,
    step_m: f64,
    array: MicrophoneArray,
}

const PARTICLES: usize = 500;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [specification, frames, rounds] = arguments.as_slice() else {
        return Err("give SPECIFICATION FRAMES ROUNDS".into());
    };
    let specification = read_specification(&std::fs::read_to_string(specification)?)?;
    let samples: Vec<f32> = std::fs::read(frames)?
        .chunks_exact(4)
        .map(|bytes| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
        .collect();
    run(&specification, &samples, rounds.parse()?)
}

fn read_specification(text: &str) -> Result<Specification, Failure> {
    let mut lines = text
        .lines()
        .map(|line| line.split_whitespace().collect::<Vec<_>>());
    let first = lines.next().ok_or("no first line")?;
    let second = lines.next().ok_or("no second line")?;
    let (["rate", rate, "length", length], ["bounds", corners @ .., "step", step]) =
        (first.as_slice(), second.as_slice())
    else {
        return Err("the specification does not begin as it should".into());
    };
    let numbers = |words: &[&str]| -> Result<[f64; 3], Failure> {
        let [x, y, z] = words else {
            return Err("three coordinates make a point".into());
        };
        Ok([x.parse()?, y.parse()?, z.parse()?])
    };
    let (low, high) = corners.split_at(3.min(corners.len()));
    let mut positions = Vec::new();
    for line in lines.filter(|line| !line.is_empty()) {
        let [x, y, z] = numbers(&line)?;
        positions.push(WorldPoint::new(x, y, z));
    }
    Ok(Specification {
        rate_hz: rate.parse()?,
        length: length.parse()?,
        bounds: Bounds {
            low_m: numbers(low)?,
            high_m: numbers(high)?,
        },
        step_m: step.parse()?,
        array: MicrophoneArray::new(positions)?,
    })
}

fn run(specification: &Specification, samples: &[f32], rounds: u32) -> Result<(), Failure> {
    let Specification {
        rate_hz,
        length,
        bounds,
        step_m,
        array,
    } = specification;
    let transform = transform_length(*length, array.max_delay_s(), *rate_hz);
    let mut analyzer = SpectrumAnalyzer::new(*length, transform, Window::Hann)?;
    let mut response = SteeredResponse::new(array, transform, *rate_hz, SteeredSettings::default())?;
    let grid = bounds.grid(*step_m)?;
    let table = response.table(&grid);
    let mut search = Search::new(&response, *bounds, SearchSettings::default())?;
    let particles: [Vec<f32>; 3] = std::array::from_fn(|axis| {
        grid.iter()
            .cycle()
            .step_by(17)
            .take(PARTICLES)
            .map(|point| point.0[axis] as f32)
            .collect()
    });
    let mut spectra = Spectra::default();
    let (mut scores, mut few) = (Vec::new(), vec![0.0; PARTICLES]);
    let frame_samples = length * array.positions().len();
    let frames: Vec<Vec<Vec<f32>>> = samples
        .chunks_exact(frame_samples)
        .map(|frame| frame.chunks_exact(*length).map(<[f32]>::to_vec).collect())
        .collect();
    let mut spent = [0_u64; 5];
    let mut answers = Vec::new();
    for round in 0..rounds.max(1) {
        for frame in &frames {
            let mut times = [0; 6];
            times[0] = now();
            analyzer.transform_all(frame, &mut spectra)?;
            times[1] = now();
            response.observe(&spectra.channels)?;
            times[2] = now();
            response.score_table(&table, &mut scores)?;
            times[3] = now();
            let [x, y, z] = &particles;
            response.score_points([x, y, z], &mut few);
            times[4] = now();
            let found = search.find(&mut response, |_| 0.0)?;
            times[5] = now();
            for (spent, pair) in spent.iter_mut().zip(times.windows(2)) {
                *spent += pair[1] - pair[0];
            }
            if round == 0 {
                let best = scores.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
                let best = grid[best.map_or(0, |(place, _)| place)].0;
                let found = found.point.0;
                answers.push(format!(
                    "[[{}, {}, {}], [{}, {}, {}]]",
                    best.x, best.y, best.z, found.x, found.y, found.z
                ));
            }
        }
    }
    let calls = u64::from(rounds.max(1)) * frames.len().max(1) as u64;
    let [transforms, curves, table_ns, points, searched] = spent.map(|sum| sum / calls);
    println!(
        "{{\"points\": {}, \"transforms\": {transforms}, \"curves\": {curves}, \"table\": {table_ns}, \
         \"particles\": {points}, \"search\": {searched}, \"coarse_points\": {}, \"found\": [{}]}}",
        grid.len(),
        search.coarse_points(),
        answers.join(", ")
    );
    Ok(())
}

/// Nanoseconds of this thread's processor time.
fn now() -> u64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
}
