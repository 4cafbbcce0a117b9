//! One call: its arguments become references and slices once they are known to be usable, and nothing unwinds
//! out of it.

use crate::number::Number;
use crate::status::{Error, Failure, Outcome, Status, put_text};
use helfrich::{Surface, TriangleMesh};
use std::borrow::Cow;
use std::ffi::{CStr, c_char};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The arguments of one call so far.
pub(crate) struct Call {
    /// The name and the bytes of each, and whether it is written.
    seen: Vec<(&'static str, Range<usize>, bool)>,
}

/// Runs the work of a call, and reports its outcome.
///
/// # Safety
/// All pointers that `work` passes to its [`Call`], and `error`, keep the contract at the head of this crate.
pub(crate) unsafe fn guarded(error: *mut Error, work: impl FnOnce(&mut Call) -> Outcome) -> Status {
    let outcome = catch_unwind(AssertUnwindSafe(|| work(&mut Call { seen: Vec::new() })));
    let outcome = outcome.unwrap_or_else(|panic| {
        let text = panic
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| panic.downcast_ref::<&str>().copied());
        Err(Failure::new(Status::Internal, text.unwrap_or("a panic")))
    });
    let (status, text) = match outcome {
        Ok(()) => (Status::Ok, String::new()),
        Err(failure) => (failure.status, failure.text),
    };
    if !error.is_null() && error.is_aligned() {
        // SAFETY: the caller owns this structure. Its fields are written one by one, because it need not
        // hold a valid status before.
        unsafe {
            (&raw mut (*error).status).write(status);
            let bytes = (&raw mut (*error).text).cast::<c_char>();
            put_text(
                &text,
                std::slice::from_raw_parts_mut(bytes, crate::status::TEXT_BYTES),
            );
        }
    }
    status
}

impl Call {
    /// Checks a pointer to `count` values and its distance from other arguments.
    fn check<T>(
        &mut self,
        name: &'static str,
        pointer: *const T,
        count: usize,
        written: bool,
    ) -> Outcome {
        if pointer.is_null() {
            let text = format!("`{name}` is NULL: a pointer is needed");
            return Err(Failure::new(Status::NullPointer, text));
        }
        if !pointer.is_aligned() {
            let text = format!(
                "`{name}` is misaligned: its address has to be a multiple of {}",
                align_of::<T>()
            );
            return Err(Failure::argument(text));
        }
        let start = pointer.addr();
        let bytes = count.checked_mul(size_of::<T>());
        let end = bytes
            .filter(|bytes| isize::try_from(*bytes).is_ok())
            .and_then(|bytes| start.checked_add(bytes));
        let Some(end) = end else {
            let text = format!("`{name}` has {count} entries, more than memory can hold");
            return Err(Failure::new(Status::InvalidCount, text));
        };
        for (other, bytes, other_written) in &self.seen {
            let apart = end <= bytes.start || bytes.end <= start;
            if !apart && (written || *other_written) {
                let text = format!("`{name}` overlaps `{other}`: separate arrays are needed");
                return Err(Failure::argument(text));
            }
        }
        self.seen.push((name, start..end, written));
        Ok(())
    }

    /// An array that is read.
    pub(crate) fn read<'a, T>(
        &mut self,
        name: &'static str,
        pointer: *const T,
        count: usize,
    ) -> Result<&'a [T], Failure> {
        if count == 0 {
            return Ok(&[]);
        }
        self.check(name, pointer, count, false)?;
        // SAFETY: not null, aligned, of a possible size; by the contract it has as many entries, and lives
        // and stays unchanged during the call. Types are numbers, for which all bits are valid.
        Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
    }

    /// Numbers at the vertices of a mesh, whose count is compared before they are read.
    pub(crate) fn at_vertices<'a, N: Number, const D: usize>(
        &mut self,
        name: &'static str,
        pointer: *const [N; D],
        count: usize,
        mesh: &TriangleMesh,
    ) -> Result<Cow<'a, [[f64; D]]>, Failure> {
        of_vertices(name, count, mesh)?;
        Ok(N::widen(self.read(name, pointer, count)?))
    }

    /// A field of finite numbers at the vertices of a mesh.
    pub(crate) fn field<'a, N: Number, const D: usize>(
        &mut self,
        name: &'static str,
        pointer: *const [N; D],
        count: usize,
        mesh: &TriangleMesh,
    ) -> Result<Cow<'a, [[f64; D]]>, Failure> {
        let field = self.at_vertices(name, pointer, count, mesh)?;
        let finite = |numbers: &[f64; D]| numbers.iter().all(|number| number.is_finite());
        let Some(vertex) = field.iter().position(|numbers| !finite(numbers)) else {
            return Ok(field);
        };
        let found = match field[vertex].as_slice() {
            [number] => number.to_string(),
            numbers => format!("{numbers:?}"),
        };
        let text = format!("`{name}` is {found} at vertex {vertex}: finite numbers are needed");
        Err(Failure::argument(text))
    }

    /// An array that is written.
    pub(crate) fn write<'a, T>(
        &mut self,
        name: &'static str,
        pointer: *mut T,
        count: usize,
    ) -> Result<&'a mut [T], Failure> {
        if count == 0 {
            return Ok(&mut []);
        }
        self.check(name, pointer, count, true)?;
        // SAFETY: as above, and it overlaps no other argument.
        Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
    }

    /// An array that is written unless it is NULL.
    pub(crate) fn write_if_wanted<'a, T>(
        &mut self,
        name: &'static str,
        pointer: *mut T,
        count: usize,
    ) -> Result<Option<&'a mut [T]>, Failure> {
        if pointer.is_null() {
            return Ok(None);
        }
        self.write(name, pointer, count).map(Some)
    }

    /// A single value that is written.
    pub(crate) fn place<'a, T>(
        &mut self,
        name: &'static str,
        pointer: *mut T,
    ) -> Result<&'a mut T, Failure> {
        self.check(name, pointer, 1, true)?;
        // SAFETY: as above.
        Ok(unsafe { &mut *pointer })
    }

    /// An object of this library, or a structure of the caller, that is read.
    pub(crate) fn object<'a, T>(
        &mut self,
        name: &'static str,
        pointer: *const T,
    ) -> Result<&'a T, Failure> {
        self.check(name, pointer, 1, false)?;
        // SAFETY: as above; by the contract an object was returned by this library and lives.
        Ok(unsafe { &*pointer })
    }

    /// An object of this library that changes.
    pub(crate) fn object_mut<'a, T>(
        &mut self,
        name: &'static str,
        pointer: *mut T,
    ) -> Result<&'a mut T, Failure> {
        self.place(name, pointer)
    }

    /// Different objects of this library that change.
    pub(crate) fn objects_mut<'a, T>(
        &mut self,
        name: &'static str,
        pointers: &[*mut T],
    ) -> Result<Vec<&'a mut T>, Failure> {
        let mut sorted = pointers.to_vec();
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            let mut same = pointers
                .iter()
                .enumerate()
                .filter(|(_, at)| **at == pair[0]);
            let mut next = || same.next().map_or(0, |(index, _)| index);
            let (first, second) = (next(), next());
            let text = format!("`{name}` has the same object at {first} and {second}: each once");
            return Err(Failure::argument(text));
        }
        // They are known to differ from each other, and compared with the other arguments only.
        let others = self.seen.len();
        let mut objects = Vec::with_capacity(pointers.len());
        for &pointer in pointers {
            objects.push(self.object_mut(name, pointer)?);
            self.seen.truncate(others);
        }
        Ok(objects)
    }

    /// Sets a pointer of the caller to a new object, which the caller owns.
    pub(crate) fn give<T>(&mut self, name: &'static str, place: *mut *mut T, object: T) -> Outcome {
        let place = self.place(name, place)?;
        *place = Box::into_raw(Box::new(object));
        Ok(())
    }

    /// A text that is read.
    pub(crate) fn text<'a>(
        &mut self,
        name: &'static str,
        pointer: *const c_char,
    ) -> Result<&'a str, Failure> {
        self.check(name, pointer, 1, false)?;
        // SAFETY: by the contract the text ends with a zero byte.
        let text = unsafe { CStr::from_ptr(pointer) };
        text.to_str().map_err(|error| {
            let at = error.valid_up_to();
            Failure::argument(format!("`{name}` is no text in UTF-8: byte {at} is wrong"))
        })
    }

    /// Writes a text with a zero byte at its end into an array of the caller.
    pub(crate) fn put(&mut self, text: &str, into: *mut c_char, capacity: usize) -> Outcome {
        let needed = text.len() + 1;
        if capacity < needed {
            return Err(Failure::count(
                "text",
                capacity,
                needed,
                "with the zero byte at its end",
            ));
        }
        put_text(text, self.write("text", into, capacity)?);
        Ok(())
    }
}

/// Frees an object; NULL is ignored.
///
/// # Safety
/// It is NULL, or was made by [`Call::give`] and is not used any more.
pub(crate) unsafe fn free<T>(object: *mut T) {
    if object.is_null() {
        return;
    }
    // A destructor that panics has freed what it could.
    let _ = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: the caller passes what `give` made, once.
        drop(unsafe { Box::from_raw(object) });
    }));
}

/// A surface, if positions are valid.
pub(crate) fn surface<'a>(
    mesh: &'a TriangleMesh,
    positions: &'a [[f64; 3]],
) -> Result<Surface<'a, f64>, Failure> {
    Ok(Surface::new(mesh, positions)?)
}

/// Refuses results that are not finite, `width` numbers for each `place`, such as a vertex.
pub(crate) fn finite<N: Number>(
    name: &str,
    place: &str,
    results: impl IntoIterator<Item = N>,
    width: usize,
) -> Outcome {
    let mut results = results.into_iter().map(N::wide).enumerate();
    match results.find(|(_, result)| !result.is_finite()) {
        None => Ok(()),
        Some((at, result)) => Err(beyond(
            &format!("`{name}` at {place} {}", at / width),
            result,
        )),
    }
}

/// The failure of a result that is not finite.
fn beyond(what: &str, result: f64) -> Failure {
    let text = format!(
        "{what} is {result}, beyond the numbers of its type: choose other units, or other positions"
    );
    Failure::new(Status::Undefined, text)
}

/// Refuses a result that is not finite.
pub(crate) fn finite_sum<N: Number>(name: &str, result: N) -> Result<N, Failure> {
    match result.wide() {
        wide if wide.is_finite() => Ok(result),
        wide => Err(beyond(&format!("`{name}`"), wide)),
    }
}

/// Checks the number of entries of an array with one for each vertex.
pub(crate) fn of_vertices(name: &str, count: usize, mesh: &TriangleMesh) -> Outcome {
    match mesh.vertex_count() {
        vertices if vertices == count => Ok(()),
        vertices => Err(Failure::count(name, count, vertices, "one for each vertex")),
    }
}
