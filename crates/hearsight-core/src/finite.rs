//! Whether every number in a value is finite, whatever the value is made of.
//!
//! Written as JSON, a number that is not finite becomes null and is lost. What is saved, restored or published is looked
//! through here at once, so that a new field needs no check of its own.

use serde::Serialize;
use serde::ser::{
    SerializeMap, SerializeSeq, SerializeStruct, SerializeStructVariant, SerializeTuple,
    SerializeTupleStruct, SerializeTupleVariant, Serializer,
};
use std::fmt;

/// Whether no number in `value` is infinite or not a number. Allocates nothing, and ends at the first that is.
///
/// What cannot be serialized is taken as not finite.
pub fn is_finite<T: Serialize + ?Sized>(value: &T) -> bool {
    value.serialize(Look).is_ok()
}

/// Looks at every number and writes nothing.
#[derive(Clone, Copy)]
struct Look;

/// A number that is not finite was met.
#[derive(Debug)]
struct NotFinite;

impl fmt::Display for NotFinite {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number is not finite")
    }
}

impl std::error::Error for NotFinite {}

impl serde::ser::Error for NotFinite {
    fn custom<T: fmt::Display>(_message: T) -> Self {
        Self
    }
}

type Looked = Result<(), NotFinite>;

macro_rules! always_finite {
    ($($method:ident: $kind:ty),* $(,)?) => {
        $(fn $method(self, _value: $kind) -> Looked {
            Ok(())
        })*
    };
}

impl Serializer for Look {
    type Ok = ();
    type Error = NotFinite;
    type SerializeSeq = Self;
    type SerializeTuple = Self;
    type SerializeTupleStruct = Self;
    type SerializeTupleVariant = Self;
    type SerializeMap = Self;
    type SerializeStruct = Self;
    type SerializeStructVariant = Self;

    always_finite! {
        serialize_bool: bool,
        serialize_i8: i8,
        serialize_i16: i16,
        serialize_i32: i32,
        serialize_i64: i64,
        serialize_u8: u8,
        serialize_u16: u16,
        serialize_u32: u32,
        serialize_u64: u64,
        serialize_char: char,
        serialize_str: &str,
        serialize_bytes: &[u8],
        serialize_unit_struct: &'static str,
    }

    fn serialize_f32(self, value: f32) -> Looked {
        if value.is_finite() { Ok(()) } else { Err(NotFinite) }
    }

    fn serialize_f64(self, value: f64) -> Looked {
        if value.is_finite() { Ok(()) } else { Err(NotFinite) }
    }

    fn serialize_none(self) -> Looked {
        Ok(())
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Looked {
        value.serialize(self)
    }

    fn serialize_unit(self) -> Looked {
        Ok(())
    }

    fn serialize_unit_variant(self, _name: &'static str, _index: u32, _variant: &'static str) -> Looked {
        Ok(())
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _name: &'static str, value: &T) -> Looked {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _name: &'static str,
        _index: u32,
        _variant: &'static str,
        value: &T,
    ) -> Looked {
        value.serialize(self)
    }

    fn serialize_seq(self, _length: Option<usize>) -> Result<Self, NotFinite> {
        Ok(self)
    }

    fn serialize_tuple(self, _length: usize) -> Result<Self, NotFinite> {
        Ok(self)
    }

    fn serialize_tuple_struct(self, _name: &'static str, _length: usize) -> Result<Self, NotFinite> {
        Ok(self)
    }

    fn serialize_tuple_variant(
        self,
        _name: &'static str,
        _index: u32,
        _variant: &'static str,
        _length: usize,
    ) -> Result<Self, NotFinite> {
        Ok(self)
    }

    fn serialize_map(self, _length: Option<usize>) -> Result<Self, NotFinite> {
        Ok(self)
    }

    fn serialize_struct(self, _name: &'static str, _length: usize) -> Result<Self, NotFinite> {
        Ok(self)
    }

    fn serialize_struct_variant(
        self,
        _name: &'static str,
        _index: u32,
        _variant: &'static str,
        _length: usize,
    ) -> Result<Self, NotFinite> {
        Ok(self)
    }

    fn collect_str<T: fmt::Display + ?Sized>(self, _value: &T) -> Looked {
        Ok(())
    }
}

macro_rules! look_at_parts {
    ($($kind:ident::$method:ident),* $(,)?) => {
        $(impl $kind for Look {
            type Ok = ();
            type Error = NotFinite;

            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Looked {
                value.serialize(*self)
            }

            fn end(self) -> Looked {
                Ok(())
            }
        })*
    };
}

look_at_parts!(
    SerializeSeq::serialize_element,
    SerializeTuple::serialize_element,
    SerializeTupleStruct::serialize_field,
    SerializeTupleVariant::serialize_field,
);

macro_rules! look_at_fields {
    ($($kind:ident),* $(,)?) => {
        $(impl $kind for Look {
            type Ok = ();
            type Error = NotFinite;

            fn serialize_field<T: Serialize + ?Sized>(&mut self, _name: &'static str, value: &T) -> Looked {
                value.serialize(*self)
            }

            fn end(self) -> Looked {
                Ok(())
            }
        })*
    };
}

look_at_fields!(SerializeStruct, SerializeStructVariant);

impl SerializeMap for Look {
    type Ok = ();
    type Error = NotFinite;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Looked {
        key.serialize(*self)
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Looked {
        value.serialize(*self)
    }

    fn end(self) -> Looked {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{BoxRecord, Scene, SoundRecord};
    use std::collections::BTreeMap;

    #[test]
    fn a_number_is_found_wherever_it_hides() {
        #[derive(Serialize)]
        enum Shape {
            Empty,
            Tuple(f64, u8),
            Struct { radius: f32 },
        }
        assert!(is_finite(&(1.0, "NaN", [0_u8; 3], None::<f64>, Shape::Empty)));
        assert!(is_finite(&vec![Some(f32::MAX), Some(-0.0)]));
        assert!(!is_finite(&vec![Some(0.0), Some(f32::NEG_INFINITY)]));
        assert!(is_finite(&Shape::Tuple(1.0, 1)) && !is_finite(&Shape::Tuple(f64::NAN, 1)));
        assert!(!is_finite(&Shape::Struct { radius: f32::NAN }));
        assert!(!is_finite(&BTreeMap::from([("a", 1.0), ("b", f64::INFINITY)])));
    }

    #[test]
    fn a_scene_with_one_bad_number_is_not_finite() {
        let sound = SoundRecord {
            array: "pair".into(),
            delay_s: 1e-4,
            column_px: Some(3.0),
            signal_to_noise_db: 20.0,
            from_onset: true,
            position_m: None,
            deviation_m: None,
            track: None,
        };
        let mut scene = Scene {
            sounds: vec![sound],
            ..Scene::default()
        };
        assert!(is_finite(&scene));
        scene.sounds[0].column_px = Some(f64::NAN);
        assert!(!is_finite(&scene));
        let head = BoxRecord {
            left: 0.0,
            top: f64::INFINITY,
            width: 1.0,
            height: 1.0,
        };
        assert!(!is_finite(&head));
    }
}
