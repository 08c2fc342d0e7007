//! Vertex attributes, one column of numbers per attribute.

use crate::draw::{AttributeData, DrawCall};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_scene::{SceneError, over_budget};
use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::{Formatter, Result as FmtResult};

/// Vertices that a dump holds at most; apitrace leaves out the others.
pub(crate) const MOST_DUMPED: usize = 4096;

/// All values of one attribute.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct AttributeColumn {
    /// Components per vertex, 1..=4.
    pub size: usize,
    /// `size` numbers per vertex.
    pub values: Vec<f32>,
}

impl AttributeColumn {
    /// Returns the first N components of each vertex; missing components are those of `filling`.
    pub fn rows<const N: usize>(&self, filling: [f32; N]) -> Vec<[f32; N]> {
        let row = |components: &[f32]| {
            let mut row = filling;
            row.iter_mut().zip(components).for_each(|(to, from)| *to = *from);
            row
        };
        self.values.chunks_exact(self.size.max(1)).map(row).collect()
    }
}

/// The attributes of a list of vertices, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct VertexColumns {
    pub count: usize,
    pub columns: BTreeMap<String, AttributeColumn>,
}

impl VertexColumns {
    /// Returns the attributes of a draw call that holds its own.
    pub fn of_draw(draw: &DrawCall, budget: &MemoryPool) -> Result<(Self, MemoryReservation), SceneError> {
        let mut held = budget.empty_reservation();
        let mut result = Self::default();
        for (name, attribute) in &draw.attributes {
            let place = format!("/draw/attributes/{name}");
            held.try_grow(attribute.data.len() as u64, "vertex attributes").map_err(|e| over_budget(&*place, &e))?;
            let column = decoded(attribute, &place)?;
            let count = column.values.len() / column.size;
            if !result.columns.is_empty() && result.count != count {
                let what = format!("has {count} vertices, other attributes have {}", result.count);
                return Err(SceneError::at(place, what).expected("as many values of each attribute"));
            }
            result.count = count;
            result.columns.insert(name.clone(), column);
        }
        Ok((result, held))
    }
}

fn decoded(attribute: &AttributeData, place: &str) -> Result<AttributeColumn, SceneError> {
    let size = attribute.size;
    if !(1..=4).contains(&size) {
        return Err(SceneError::at(format!("{place}/size"), format!("is {size}")).expected("1 to 4 components"));
    }
    let bytes = STANDARD
        .decode(&attribute.data)
        .map_err(|e| SceneError::at(format!("{place}/data"), format!("not base64: {e}")).expected("base64"))?;
    if !bytes.len().is_multiple_of(4 * size) {
        let what = format!("holds {} bytes", bytes.len());
        return Err(SceneError::at(format!("{place}/data"), what).expected(format!("a multiple of {}", 4 * size)));
    }
    let values = bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    Ok(AttributeColumn { size, values })
}

impl<'de> Deserialize<'de> for VertexColumns {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(ColumnsVisitor)
    }
}

struct ColumnsVisitor;

impl<'de> Visitor<'de> for ColumnsVisitor {
    type Value = VertexColumns;

    fn expecting(&self, f: &mut Formatter<'_>) -> FmtResult {
        f.write_str("a list of vertices")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<VertexColumns, A::Error> {
        let mut result = VertexColumns::default();
        while let Some(Row(row)) = list.next_element()? {
            let first = result.count == 0;
            for (name, values) in row {
                if first {
                    let column = AttributeColumn { size: values.len(), values: Vec::new() };
                    result.columns.insert(name.clone(), column);
                }
                let column = result.columns.get_mut(&name).filter(|column| column.size == values.len());
                let Some(column) = column else {
                    return Err(A::Error::custom(format!("`{name}` differs in size from the first vertex")));
                };
                column.values.extend(values);
            }
            result.count += 1;
            if let Some((name, _)) = result.columns.iter().find(|(_, c)| c.values.len() != result.count * c.size) {
                return Err(A::Error::custom(format!("`{name}` must be given once for each vertex")));
            }
        }
        Ok(result)
    }
}

/// The attributes of one vertex. Attributes of other types than numbers and vectors are left out.
struct Row(Vec<(String, Vec<f32>)>);

impl<'de> Deserialize<'de> for Row {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct RowVisitor;
        impl<'de> Visitor<'de> for RowVisitor {
            type Value = Row;
            fn expecting(&self, f: &mut Formatter<'_>) -> FmtResult {
                f.write_str("an object of vertex attributes")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Row, A::Error> {
                let mut row = Vec::new();
                while let Some((name, value)) = map.next_entry::<String, Value>()? {
                    row.extend(components(&value).map(|values| (name, values)));
                }
                Ok(Row(row))
            }
        }
        deserializer.deserialize_map(RowVisitor)
    }
}

/// Returns the components of a number or of a list of one to four numbers.
fn components(value: &Value) -> Option<Vec<f32>> {
    let list = match value {
        Value::Array(list) => list.as_slice(),
        other => std::slice::from_ref(other),
    };
    (1..=4).contains(&list.len()).then_some(())?;
    list.iter().map(|number| Some(number.as_f64()? as f32)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_become_columns() {
        let text = r#"[{"p": [1, 2, 3], "id": 7, "m": [[1], [2]]}, {"p": [4, 5, 6], "id": 8, "m": [[1], [2]]}]"#;
        let columns: VertexColumns = serde_json::from_str(text).unwrap();
        assert_eq!((columns.count, columns.columns.len()), (2, 2));
        assert_eq!(columns.columns["p"].rows([0.0; 3]), [[1., 2., 3.], [4., 5., 6.]]);
        assert_eq!(columns.columns["p"].rows([0.0, 0.0, 0.0, 1.0])[1], [4., 5., 6., 1.]);
        assert_eq!(columns.columns["id"], AttributeColumn { size: 1, values: vec![7., 8.] });
    }

    #[test]
    fn uneven_vertices_are_an_error() {
        for text in [
            r#"[{"p": [1, 2]}, {"p": [1]}]"#,
            r#"[{"p": [1]}, {}]"#,
            r#"[{"p": [1]}, {"p": [1], "q": [2]}]"#,
            r#"[{"p": [1, 2]}, {"p": [1], "p": [2]}]"#,
        ] {
            assert!(serde_json::from_str::<VertexColumns>(text).is_err(), "{text}");
        }
    }

    #[test]
    fn faulty_attribute_data_is_named() {
        let draw = |size, data: &str| DrawCall {
            attributes: [("p".to_owned(), AttributeData { size, data: data.into() })].into(),
            ..DrawCall::default()
        };
        let says =
            |size, data: &str| VertexColumns::of_draw(&draw(size, data), &MemoryPool::default()).err().unwrap().to_string();
        assert_eq!(says(5, ""), "/draw/attributes/p/size: is 5; expected 1 to 4 components");
        assert!(says(1, "?").starts_with("/draw/attributes/p/data: not base64"));
        assert_eq!(says(2, "AAAAAA=="), "/draw/attributes/p/data: holds 4 bytes; expected a multiple of 8");
        let (columns, _) = VertexColumns::of_draw(&draw(1, "AACAPwAAAEA="), &MemoryPool::default()).unwrap();
        assert_eq!((columns.count, columns.columns["p"].values.clone()), (2, vec![1.0, 2.0]));
    }
}
