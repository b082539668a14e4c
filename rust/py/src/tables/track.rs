//! How far a vehicle went, from one position to the next.

use mavwire_core::codec::{Number, number};
use pyo3::prelude::*;

use crate::message::info::{Info, Place as FieldPlace};
use crate::message::object::Message;
use crate::message::values::scalar;
use crate::sync::lock::Lock;

/// Metres: the mean radius of the Earth.
const RADIUS: f64 = 6_371_000.0;

/// A point on a sphere, in radians.
#[derive(Clone, Copy)]
struct Place {
    lat: f64,
    lon: f64,
    cos_lat: f64,
}

impl Place {
    fn new(lat: f64, lon: f64) -> Self {
        let lat = lat.to_radians();
        Self { lat, lon: lon.to_radians(), cos_lat: lat.cos() }
    }

    /// Metres between two points (haversine).
    fn distance(self, to: Self) -> f64 {
        let (lat, lon) = (to.lat - self.lat, to.lon - self.lon);
        let a = (lat / 2.0).sin().powi(2) + (lon / 2.0).sin().powi(2) * self.cos_lat * to.cos_lat;
        RADIUS * 2.0 * a.sqrt().atan2((1.0 - a).max(0.0).sqrt())
    }
}

/// The fields of `GPS_RAW_INT`.
const FIELDS: [&str; 4] = ["lat", "lon", "fix_type", "time_usec"];
const FIX_3D: f64 = 3.0;
/// Of latitudes and longitudes in a degree.
const UNITS: f64 = 1.0e7;

/// Where the fields of a message with a position stand among its own.
type Gps = (&'static Info, [usize; 4]);

fn gps(info: &'static Info) -> Option<Gps> {
    let mut places = [0; 4];
    for (place, name) in places.iter_mut().zip(FIELDS) {
        *place = info.field(name)?.0;
    }
    Some((info, places))
}

/// Latitude and longitude in degrees.
type Degrees = (f64, f64);

#[derive(Default)]
struct Way {
    metres: f64,
    start: Option<Degrees>,
    end: Option<Degrees>,
    last: Option<Place>,
    stamp: Option<Py<PyAny>>,
    /// Of the message before.
    gps: Option<Gps>,
}

impl Way {
    fn add(&mut self, lat: f64, lon: f64) {
        let place = Place::new(lat, lon);
        if let Some(last) = self.last.replace(place) {
            self.metres += last.distance(place);
        }
        self.start = self.start.or(Some((lat, lon)));
        self.end = Some((lat, lon));
    }
}

/// The length of a way in `metres`, and the positions (degrees) at its `start` and `end`.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct Track(Lock<Way>);

impl Track {
    /// Where the fields stand, and the payload, of a message as it was received.
    fn plain<'a>(&self, message: &'a Bound<'_, Message>) -> Option<(Gps, &'a [u8])> {
        let this = message.get();
        let info = this.info.filter(|_| this.is_pristine())?;
        let mut way = self.0.lock(message.py());
        if way.gps.is_none_or(|(known, _)| !std::ptr::eq(known, info)) {
            way.gps = gps(info);
        }
        Some((way.gps?, this.decoded_payload()))
    }

    fn go_on<'py>(
        &self,
        lat: f64,
        lon: f64,
        fix: f64,
        stamp: impl FnOnce() -> PyResult<Bound<'py, PyAny>>,
    ) -> PyResult<()> {
        if lat == 0.0 || lon == 0.0 || fix.is_nan() || fix < FIX_3D {
            return Ok(());
        }
        self.add(lat / UNITS, lon / UNITS, stamp()?)
    }
}

#[pymethods]
impl Track {
    #[new]
    fn new() -> Self {
        Self(Lock::new(Way::default()))
    }

    /// Goes on to a position, in degrees. One whose stamp is the last one's is the same one.
    fn add(&self, lat: f64, lon: f64, stamp: Bound<'_, PyAny>) -> PyResult<()> {
        let state = || self.0.lock(stamp.py());
        let before = state().stamp.replace(stamp.clone().unbind());
        let is_same = before.map_or(Ok(false), |before| before.bind(stamp.py()).eq(&stamp))?;
        if !is_same {
            state().add(lat, lon);
        }
        Ok(())
    }

    /// Goes on to the position that a `GPS_RAW_INT` tells, if it has a fix.
    fn follow(&self, message: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = message.py();
        let plain = message.cast::<Message>().ok().and_then(|message| self.plain(message));
        let Some(((info, places), payload)) = plain else {
            let [lat, lon, fix, stamp] = FIELDS.map(|name| message.getattr(name));
            return self.go_on(lat?.extract()?, lon?.extract()?, fix?.extract()?, || stamp);
        };
        let [lat, lon, fix, stamp] = places.map(|index| info.places[index]);
        let number =
            |place: FieldPlace| match number(place.field_type, payload, place.offset.into()) {
                Number::Signed(value) => value as f64,
                Number::Unsigned(value) => value as f64,
                Number::Float(value) => value,
            };
        let stamp = || {
            scalar(py, stamp.field_type, payload, stamp.offset.into()).map(|one| one.into_bound(py))
        };
        self.go_on(number(lat), number(lon), number(fix), stamp)
    }

    #[getter]
    fn metres(&self, py: Python<'_>) -> f64 {
        self.0.lock(py).metres
    }

    #[getter]
    fn start(&self, py: Python<'_>) -> Option<Degrees> {
        self.0.lock(py).start
    }

    #[getter]
    fn end(&self, py: Python<'_>) -> Option<Degrees> {
        self.0.lock(py).end
    }
}
