//! `hearsight evaluate`: how well did it do, beside the truth?

use crate::exit::Code;
use crate::say;
use hearsight::eval::read::{FormatInfo, format_of_name, read};
use hearsight::eval::{Measure, Options, Report, Side, list_of_metrics, pair};
use miette::{Context, IntoDiagnostic, miette};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  hearsight evaluate truth/ tracks/ --html report.html    what `simulate` and `track` wrote
  hearsight evaluate gt.txt test.txt                      MOTChallenge text
  hearsight evaluate truth.rttm speech.rttm --collar 0.5 --skip-overlap
  hearsight evaluate truth/ tracks/ --distance metres --gate 0.3 --azimuth-from 0,0.4
  hearsight evaluate one/gt.txt one/test.txt two/gt.txt two/test.txt    several, merged from counts";

#[derive(clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", list_of_metrics()))]
pub(crate) struct Arguments {
    /// What is really so: a file, or a directory of `hearsight simulate`, of AV16.3, or of files.
    truth: PathBuf,
    /// What was found: a file, or a directory of `hearsight track`.
    tracks: PathBuf,
    /// Further pairs of TRUTH and TRACKS; all are merged from counts.
    #[arg(value_name = "MORE")]
    more: Vec<PathBuf>,
    /// Write everything as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write one page of HTML with plots; it needs nothing else.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    how: How,
}

/// How it is judged.
#[derive(clap::Args)]
struct How {
    /// What distances are: overlap of boxes, pixels between mouths, metres in the world. Default: the first of these that
    /// both sides have.
    #[arg(long, value_enum)]
    distance: Option<Distance>,
    /// Pairs farther apart are no match, in that distance; for iou it is 1 - overlap. Default: 0.5, 30 px, 0.5 m.
    #[arg(long)]
    gate: Option<f64>,
    /// Judge the picture of this camera only.
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// People of whom a smaller part can be seen do not count, nor tracks on them; 0 to 1.
    #[arg(long, value_name = "PART", default_value_t = 0.0)]
    least_visibility: f64,
    /// Seconds cut out around each boundary of the truth's speech, half on either side.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    collar: f64,
    /// Cut out time at which several people speak.
    #[arg(long)]
    skip_overlap: bool,
    /// Give errors of azimuth as seen from here, metres.
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    azimuth_from: Option<[f64; 2]>,
    /// Format of the truth, where name and content do not tell: truth, scenes, mot, rttm, frames-csv, places-csv.
    #[arg(long, value_name = "FORMAT", value_parser = format)]
    truth_format: Option<&'static FormatInfo>,
    /// Format of the tracks.
    #[arg(long, value_name = "FORMAT", value_parser = format)]
    tracks_format: Option<&'static FormatInfo>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Distance {
    Iou,
    Pixels,
    Metres,
}

fn place(text: &str) -> Result<[f64; 2], String> {
    let numbers: Vec<f64> = text
        .split(',')
        .filter_map(|part| part.trim().parse().ok())
        .collect();
    match numbers.as_slice() {
        [x, y] if text.split(',').count() == 2 => Ok([*x, *y]),
        _ => Err("give two numbers of metres, as 0,0.4".to_owned()),
    }
}

fn format(text: &str) -> Result<&'static FormatInfo, String> {
    format_of_name(text).map_err(|error| error.to_string())
}

/// Judges.
pub(crate) fn run(arguments: &Arguments) -> miette::Result<Code> {
    let how = &arguments.how;
    let options = Options {
        measure: how.distance.map(|distance| match distance {
            Distance::Iou => Measure::Overlap,
            Distance::Pixels => Measure::Pixels,
            Distance::Metres => Measure::Metres,
        }),
        gate: how.gate,
        camera: how.camera.clone(),
        least_visibility: how.least_visibility,
        collar_s: how.collar,
        skip_overlap: how.skip_overlap,
        azimuth_from_m: how.azimuth_from,
    };
    if !arguments.more.len().is_multiple_of(2) {
        return Err(miette!(
            help = "give TRUTH and TRACKS in turn",
            "{} has no partner",
            arguments.more[arguments.more.len() - 1].display()
        ));
    }
    let mut pairs = vec![(arguments.truth.as_path(), arguments.tracks.as_path())];
    pairs.extend(
        arguments
            .more
            .chunks_exact(2)
            .map(|pair| (pair[0].as_path(), pair[1].as_path())),
    );
    let (mut cases, mut notes) = (Vec::new(), Vec::new());
    for (index, (truth, tracks)) in pairs.iter().enumerate() {
        let (of_truth, of_tracks) = std::thread::scope(|scope| {
            let other = scope.spawn(|| read(tracks, Side::Tracks, how.tracks_format));
            let of_truth = read(truth, Side::Truth, how.truth_format);
            (of_truth, other.join())
        });
        let of_truth = of_truth.into_diagnostic()?;
        let of_tracks = of_tracks
            .map_err(|_| miette!("reading {} failed", tracks.display()))?
            .into_diagnostic()?;
        let name = if pairs.len() > 1 {
            format!("{} {}", index + 1, short_name(tracks))
        } else {
            String::new()
        };
        let paired = pair(&name, &of_truth, &of_tracks, &options)
            .into_diagnostic()
            .wrap_err_with(|| format!("cannot judge {} by {}", tracks.display(), truth.display()))?;
        cases.extend(paired.cases);
        notes.extend(paired.notes);
    }
    let of_all = |side: fn(&(&Path, &Path)) -> String| pairs.iter().map(side).collect::<Vec<_>>().join(", ");
    let names = [
        of_all(|(truth, _)| truth.display().to_string()),
        of_all(|(_, tracks)| tracks.display().to_string()),
    ];
    let report = Report::new(names, cases, notes, options).into_diagnostic()?;
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&report.json()).into_diagnostic()?;
        write(path, &(text + "\n"))?;
    }
    if let Some(path) = &arguments.html {
        write(path, &report.html())?;
    }
    if !arguments.quiet {
        say::line(report.table().trim_end());
        for note in &report.notes {
            say::line(format_args!("note: {note}"));
        }
        for path in arguments.json.iter().chain(&arguments.html) {
            say::line(format_args!("written to {}", path.display()));
        }
    }
    Ok(Code::Done)
}

/// A name for one of several recordings: that of the directory, as files are often called alike.
fn short_name(path: &Path) -> String {
    let named = path
        .parent()
        .filter(|parent| !path.is_dir() && parent.file_name().is_some());
    let name = named.unwrap_or(path).file_name();
    name.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

fn write(path: &Path, text: &str) -> miette::Result<()> {
    std::fs::write(path, text).map_err(|error| {
        miette!(
            help = "check the path and the permissions",
            "cannot write {}: {error}",
            path.display()
        )
    })
}
