//! Plans that are made once for all parts of an image.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::identity::Identity;
use crate::error::{Error, Result};
use crate::film::{BlockReader, Kind, Shard, write_blocks};
use crate::plan::Plan;
use crate::scene::{RenderText, Scene};

/// The first bytes of a plan file.
const MAGIC: Kind = *b"AbbePln1";

/// What a plan was made for.
#[derive(Serialize, Deserialize)]
struct PlanHeader {
    identity: Identity,
    /// The number of samples per pixel, if it was requested.
    samples: Option<u32>,
    /// The error and the time in seconds that end a render. Plans for parts do not have them.
    error: Option<f64>,
    time: Option<f64>,
}

impl PlanHeader {
    fn new(scene: &Scene, plan: &Plan) -> Self {
        let identity = Identity::new(scene, &plan.method, Shard::WHOLE).without_part();
        let RenderText { samples, error, time, is_part, .. } = scene.render;
        let [error, time] = [error, time.map(|time| time.as_secs_f64())].map(|limit| limit.filter(|_| !is_part));
        Self { identity, samples, error, time }
    }

    /// Returns what differs in another header, if anything does.
    fn difference(&self, other: &Self) -> Option<String> {
        let samples_text =
            |samples: Option<u32>| samples.map_or("chosen by the plan".into(), |count| count.to_string());
        let samples_difference = (self.samples != other.samples).then(|| {
            format!("its number of samples is {}, not {}", samples_text(other.samples), samples_text(self.samples))
        });
        let limits = [("error", self.error, other.error), ("time in seconds", self.time, other.time)];
        let limit_text = |limit: Option<f64>| limit.map_or("none".into(), |limit| limit.to_string());
        let limit_difference = limits.into_iter().find(|(_, own, other)| own != other);
        let limit_difference = limit_difference
            .map(|(name, own, other)| format!("its {name} is {}, not {}", limit_text(other), limit_text(own)));
        samples_difference.or(limit_difference).or_else(|| self.identity.difference(&other.identity))
    }
}

/// Writes the plan of a scene with all options applied, for [`Options::plan`](crate::Options::plan).
///
/// ```
/// # let scene = abbe::Scene::parse("camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
/// # film = { width = 8, height = 8 }
/// # light = [{ environment = { radiance = 1 } }]", "")?;
/// # let folder = tempfile::tempdir().expect("a folder");
/// # let path = folder.path().join("frame.plan");
/// abbe::write_plan(&abbe::plan::plan(&scene), &scene, &path)?;
/// let planned = abbe::Options { plan: Some(path), ..abbe::Options::default() };
/// let image = abbe::render(&scene, &planned)?;
/// assert_eq!(image.film(), abbe::render(&scene, &abbe::Options::default())?.film());
/// # Ok::<(), abbe::Error>(())
/// ```
///
/// # Errors
/// If it cannot be written. An existing file is then untouched.
pub fn write_plan(plan: &Plan, scene: &Scene, path: impl AsRef<Path>) -> Result<()> {
    let head = PlanHeader::new(scene, plan);
    write_blocks(path.as_ref(), MAGIC, &|blocks| {
        blocks.block(&head)?;
        blocks.block(plan)
    })
}

/// Reads the plan of a scene with all options applied.
///
/// # Errors
/// [`Error::Arguments`] if it does not exist, or belongs to something else; [`Error::Decode`] if it is damaged.
pub(super) fn read_plan(path: &Path, scene: &Scene) -> Result<Plan> {
    if !path.exists() {
        return Error::refuse(format!("there is no plan {}", path.display()), HOW_TO_PLAN);
    }
    let Some(mut blocks) = BlockReader::open(path, MAGIC)? else {
        return Error::refuse(format!("{} is not a plan", path.display()), HOW_TO_PLAN);
    };
    let head: PlanHeader = blocks.block()?;
    if let Some(objection) = head.identity.objection() {
        return Error::refuse(format!("cannot follow {}: {objection}", path.display()), HOW_TO_PLAN);
    }
    let plan: Plan = blocks.block()?;
    blocks.end()?;
    let is_of_whole = scene.render.is_part && (head.error.is_some() || head.time.is_some());
    match PlanHeader::new(scene, &plan).difference(&head) {
        Some(difference) => {
            let help = if is_of_whole { HOW_TO_PLAN_PARTS } else { HOW_TO_PLAN };
            Error::refuse(format!("cannot follow {}: {difference}", path.display()), help)
        }
        None => Ok(plan),
    }
}

/// How to make a plan that can be followed.
const HOW_TO_PLAN: &str = "make it with the same options: render --plan scene.toml --plan-file frame.plan";
const HOW_TO_PLAN_PARTS: &str =
    "parts take all samples, and have a plan of their own: render --plan scene.toml --shard 1/4 --plan-file frame.plan";
