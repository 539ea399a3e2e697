//! Deserializes a TOML file with placeholders for missing keys.

use super::place::{Place, Stop};
use serde::de::value::{MapDeserializer, SeqDeserializer, StrDeserializer};
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, VariantAccess, Visitor,
};
use toml::Value;

impl Place<'_> {
    fn visit_table<'de, V: Visitor<'de>>(
        self,
        fields: &[&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        let entries = self.entries(fields);
        let found = visitor.visit_map(MapDeserializer::new(entries.into_iter()));
        found.map_err(|stop| match stop {
            Stop::Key(key) => Stop::At(self.below(key, None).path),
            other => other,
        })
    }

    fn visit_list<'de, V: Visitor<'de>>(
        self,
        stand_ins: usize,
        visitor: V,
    ) -> Result<V::Value, Stop> {
        visitor.visit_seq(SeqDeserializer::new(self.elements(stand_ins).into_iter()))
    }
}

impl<'de> IntoDeserializer<'de, Stop> for Place<'_> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

/// Defines methods that deserialize a single value: the value in the file, or the given placeholder.
macro_rules! single {
    ($visit:ident($stand_in:expr): $($method:ident)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
            match self.value {
                Some(_) => self.deserialize_any(visitor),
                None => visitor.$visit($stand_in),
            }
        })*
    };
}

impl<'de> Deserializer<'de> for Place<'_> {
    type Error = Stop;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        match self.value {
            Some(Value::Table(_)) => self.visit_table(&[], visitor),
            Some(Value::Array(_)) => self.visit_list(0, visitor),
            Some(Value::String(text)) => visitor.visit_str(text),
            Some(Value::Integer(number)) => visitor.visit_i64(*number),
            Some(Value::Float(number)) => visitor.visit_f64(*number),
            Some(Value::Boolean(flag)) => visitor.visit_bool(*flag),
            Some(Value::Datetime(_)) | None => Err(Stop::Other),
        }
    }

    single! { visit_bool(false): deserialize_bool }
    single! { visit_str(""): deserialize_str deserialize_string }
    // Every numeric type accepts a u8.
    single! { visit_u8(0): deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64 deserialize_u8 deserialize_u16 }
    single! { visit_u8(0): deserialize_u32 deserialize_u64 deserialize_f32 deserialize_f64 }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        match self.value {
            Some(_) => visitor.visit_some(self),
            None => visitor.visit_none(),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Stop> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        self.visit_list(0, visitor)
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Stop> {
        self.visit_list(length, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Stop> {
        self.visit_table(&[], visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        match self.value {
            None | Some(Value::Table(_)) => self.visit_table(fields, visitor),
            Some(_) => Err(Stop::Other),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        let (variant, content) = match self.value {
            Some(Value::String(name)) => (name.clone(), None),
            Some(Value::Table(table)) if table.len() == 1 => {
                let (name, value) = table.iter().next().ok_or(Stop::Other)?;
                (name.clone(), Some(value))
            }
            Some(_) => return Err(Stop::Other),
            // The variant is unknown, so use the first one.
            None => (variants.first().ok_or(Stop::Other)?.to_string(), None),
        };
        let content = Place {
            all: self.value.is_none(),
            ..self.below(&variant, content)
        };
        visitor.visit_enum(Variant { variant, content })
    }

    serde::forward_to_deserialize_any! {
        i128 u128 char bytes byte_buf unit unit_struct tuple_struct identifier ignored_any
    }
}

struct Variant<'a> {
    variant: String,
    content: Place<'a>,
}

impl<'de, 'a> EnumAccess<'de> for Variant<'a> {
    type Error = Stop;
    type Variant = Place<'a>;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Place<'a>), Stop> {
        let name: StrDeserializer<'_, Stop> = self.variant.as_str().into_deserializer();
        Ok((seed.deserialize(name)?, self.content))
    }
}

impl<'de> VariantAccess<'de> for Place<'_> {
    type Error = Stop;

    fn unit_variant(self) -> Result<(), Stop> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Stop> {
        seed.deserialize(self)
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Stop> {
        self.visit_list(length, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Stop> {
        self.visit_table(fields, visitor)
    }
}
