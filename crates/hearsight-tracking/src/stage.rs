//! Stages: propose, score, weigh, resample. A system is a list of them, so that bootstrap, mixture, partitioned and
//! layered sampling are lists, not new code.

use crate::belief::Belief;
use crate::body::{Body, Part};
use crate::closed_loop::Fuser;
use crate::cues::{Cue, Evidence, Hypotheses, Subject};
use crate::fusion::Fusion;
use crate::percepts::{ArrayPercepts, CameraPercepts};
use crate::proposals::Proposal;
use hearsight_core::{Rectangle, Span, WorldPoint};
use hearsight_filter::{FilterError, NormalizationOutcome, Resampling};

/// One step of a filter.
pub enum Stage {
    /// Draw hypotheses.
    Propose(Box<dyn Proposal>),
    /// Draw hypotheses from what trackers with a memory of their own believe, let verifiers score them, and tell the
    /// trackers what came of it.
    Loop {
        /// The trackers and what mixes them.
        fuser: Box<Fuser>,
        /// The verifiers, each a row of scores.
        verifiers: Vec<Box<dyn Cue>>,
        /// What makes weights of the rows.
        fusion: Box<dyn Fusion>,
        /// As in [`Stage::Weigh`].
        hidden: f64,
    },
    /// Let these cues score the hypotheses, and turn their scores into weights.
    Weigh {
        /// The cues, each a row of scores.
        cues: Vec<Box<dyn Cue>>,
        /// What makes weights of the rows.
        fusion: Box<dyn Fusion>,
        /// Log-likelihood of a hypothesis that is hidden behind somebody nearer: what is seen there is not the person,
        /// and says neither that they are there nor that they are not. Not positive.
        hidden: f64,
    },
    /// Draw survivors, where the effective sample size asks for it.
    Resample {
        /// How.
        scheme: Resampling,
        /// Resample where the effective sample size is at most this share of the particles, 0 to 1; 1 is always.
        below: f64,
    },
}

/// Memory of the stages that holds nothing between two beliefs.
#[derive(Default)]
pub struct Scratch {
    regions: Vec<Rectangle>,
    sounds: Vec<Option<WorldPoint>>,
    scores: Vec<Vec<f32>>,
    evidence: Vec<Evidence>,
    log_likelihoods: Vec<f64>,
}

/// What the sensors of one view say of one belief.
pub struct Sight<'a> {
    /// From hypotheses to regions and sounds.
    pub body: &'a dyn Body,
    /// What the camera sees now.
    pub camera: &'a CameraPercepts,
    /// What the array hears now.
    pub array: Option<&'a ArrayPercepts>,
    /// Heads detected now with the weight that the belief gives each.
    pub detections: &'a [(Rectangle, f32)],
    /// Bodies nearer than the person, behind which a hypothesis cannot be seen.
    pub covers: &'a [Rectangle],
    /// Time since the step before.
    pub elapsed: Span,
}

/// Runs all stages on one belief. Returns how many particles were set aside as not finite.
///
/// # Errors
/// [`FilterError`] where a stage does not fit the body's state; that is a mistake of the composition.
pub fn run(
    stages: &[Stage],
    belief: &mut Belief,
    sight: &Sight<'_>,
    scratch: &mut Scratch,
) -> Result<usize, FilterError> {
    let mut quarantined = 0;
    for stage in stages {
        match stage {
            Stage::Propose(proposal) => {
                proposal.propose(
                    &mut belief.particles,
                    sight.elapsed,
                    sight.detections,
                    &mut belief.generator,
                )?;
            }
            Stage::Loop {
                fuser,
                verifiers,
                fusion,
                hidden,
            } => {
                fuser.propose(belief, sight)?;
                quarantined += weigh(verifiers, fusion.as_ref(), *hidden, belief, sight, scratch)?;
                fuser.close(belief, sight)?;
            }
            Stage::Weigh { cues, fusion, hidden } => {
                quarantined += weigh(cues, fusion.as_ref(), *hidden, belief, sight, scratch)?;
            }
            Stage::Resample { scheme, below } => {
                let limit = below * belief.particles.count() as f64;
                if belief.effective_sample_size <= limit {
                    belief.particles.resample(*scheme, &mut belief.generator)?;
                }
            }
        }
    }
    Ok(quarantined)
}

fn weigh(
    cues: &[Box<dyn Cue>],
    fusion: &dyn Fusion,
    hidden: f64,
    belief: &mut Belief,
    sight: &Sight<'_>,
    scratch: &mut Scratch,
) -> Result<usize, FilterError> {
    let count = belief.particles.count();
    scratch.scores.resize_with(cues.len(), Vec::new);
    scratch.evidence.clear();
    let mut mapped = None;
    for (cue, scores) in cues.iter().zip(&mut scratch.scores) {
        scores.clear();
        scores.resize(count, 0.0);
        if !cue.has_evidence(sight.camera, sight.array) {
            scratch.evidence.push(Evidence::Missing);
            continue;
        }
        let subject = cue.subject();
        if mapped != Some(subject) {
            mapped = Some(subject);
            scratch.regions.clear();
            scratch.sounds.clear();
            match subject {
                Subject::Regions(part) => sight.body.regions(&belief.particles, part, &mut scratch.regions),
                Subject::Sounds => {
                    sight.body.sound_points(&belief.particles, &mut scratch.sounds);
                }
            }
        }
        scratch.evidence.push(cue.score(
            &Hypotheses {
                regions: &scratch.regions,
                sounds: &scratch.sounds,
                appearance: &belief.appearance,
                detections: sight.detections,
                speaking: belief.speaking as f32,
                camera: sight.camera,
                array: sight.array,
            },
            scores,
        ));
    }
    scratch.log_likelihoods.clear();
    scratch.log_likelihoods.resize(count, 0.0);
    fusion.fuse(&scratch.scores, &scratch.evidence, &mut scratch.log_likelihoods);
    if !sight.covers.is_empty() {
        sight
            .body
            .regions(&belief.particles, Part::Head, &mut scratch.regions);
        for (likelihood, head) in scratch.log_likelihoods.iter_mut().zip(&scratch.regions) {
            if sight
                .covers
                .iter()
                .any(|cover| cover.intersection(head).area() > 0.5 * head.area())
            {
                *likelihood = hidden;
            }
        }
    }
    let report = belief.particles.add_log_likelihoods(&scratch.log_likelihoods)?;
    belief.effective_sample_size = report.effective_sample_size;
    if report.outcome == NormalizationOutcome::Lost {
        // Every state was not finite: begin again at the last place that was.
        let mut state = vec![0.0; sight.body.dimensions()];
        sight.body.state_from_head(&belief.head, &mut state);
        for particle in 0..count {
            belief.particles.set_state(particle, &state)?;
        }
    }
    Ok(report.quarantined)
}
