//! The report for programs. Names of metrics are those of the references; what is not defined is null.

use super::Report;
use crate::metrics::{Better, Judged, MetricInfo};
use serde_json::{Map, Value, json};

/// Version of the report.
const SCHEMA: &str = "1.0";

pub(super) fn json(report: &Report) -> Value {
    let measure = report.measure();
    let families = report.judged.iter();
    let values = |of: &dyn Fn(&Judged, usize) -> Option<f64>| -> Value {
        let mut map = Map::new();
        for (family, judged) in &report.judged {
            for (place, metric) in family.metrics().iter().enumerate() {
                map.insert(metric.name.to_owned(), number(of(judged, place)));
            }
        }
        Value::Object(map)
    };
    let cases: Vec<Value> = report
        .cases
        .iter()
        .enumerate()
        .map(|(case, info)| {
            let of_case = |judged: &Judged, place: usize| judged.of_each[case].as_ref()?[place];
            json!({"name": info.name, "values": values(&of_case)})
        })
        .collect();
    let describe = |info: &MetricInfo, source: &str| {
        json!({
            "name": info.name,
            "meaning": info.meaning,
            "unit": info.unit.name(measure),
            "least": number(Some(info.range[0])),
            "most": number(Some(info.range[1])),
            "better": match info.better {
                Better::Up => "up",
                Better::Down => "down",
                Better::Neither => "neither",
            },
            "source": source,
        })
    };
    let metrics: Vec<Value> = families
        .flat_map(|(family, _)| {
            family
                .metrics()
                .iter()
                .map(|info| describe(info, family.source()))
        })
        .collect();
    let options = &report.options;
    json!({
        "schema": SCHEMA,
        "truth": report.names[0],
        "tracks": report.names[1],
        "options": {
            "distance": match measure {
                crate::Measure::Overlap => "iou",
                crate::Measure::Pixels => "pixels",
                crate::Measure::Metres => "metres",
            },
            "gate": number(report.gate()),
            "camera": options.camera,
            "least_visibility": options.least_visibility,
            "collar_s": options.collar_s,
            "skip_overlap": options.skip_overlap,
            "azimuth_from_m": options.azimuth_from_m,
        },
        "overall": values(&|judged, place| judged.overall[place]),
        "cases": cases,
        "notes": report.notes,
        "metrics": metrics,
    })
}

/// A number; null for none and for infinities.
fn number(value: Option<f64>) -> Value {
    value
        .filter(|value| value.is_finite())
        .map_or(Value::Null, Value::from)
}
