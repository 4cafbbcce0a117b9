//! Ranks by MPI, found at run time.
//!
//! MPI 5.0 has a standard binary interface: a program that uses it runs with every library that has it, and is built without
//! any. A process that no MPI has started does not look for one. Source: MPI: A Message-Passing Interface Standard, version
//! 5.0 (2025), chapter 20, and the header `mpi_abi.h` that it defines.
//!
//! Few functions are used, all by the thread that has started them: sending and receiving of bytes in messages of known
//! lengths. [`helfrich_execute::team`] has all else.

// Functions of a library that is opened at run time can only be called so. Each call has its reason.
#![expect(unsafe_code)]

use helfrich_execute::team::{Ranks, Team};
use libloading::{Library, Symbol};
use std::env;
use std::error::Error;
use std::ffi::{c_int, c_void};
use std::mem::ManuallyDrop;
use std::path::PathBuf;
use std::process;
use std::ptr::null_mut;

/// A communicator or a type.
type Handle = *mut c_void;
/// A count of more than 2³¹ bytes.
type Count = i64;

/// `MPI_COMM_WORLD` and `MPI_BYTE` of the standard ABI.
const WORLD: usize = 0x101;
const BYTE: usize = 0x247;
/// `MPI_THREAD_FUNNELED`: only the thread that started MPI calls it.
const FUNNELED: c_int = 1024;
/// The tag of all messages, which are told apart by their order.
const TAG: c_int = 1;

/// Names of the library, by system.
const LIBRARIES: &[&str] = match cfg!(target_os = "macos") {
    true => &["libmpi_abi.1.dylib", "libmpi_abi.dylib"],
    false => &["libmpi_abi.so.1", "libmpi_abi.so"],
};

/// The variable with the path of a library.
const VARIABLE: &str = "HELFRICH_MPI";

/// Variables by which launchers tell a process how many there are: those of MPICH and its relatives, of Open MPI, and of
/// Slurm.
const SIZES: [&str; 3] = ["PMI_SIZE", "OMPI_COMM_WORLD_SIZE", "SLURM_STEP_NUM_TASKS"];

/// Reason why the processes of a run cannot find each other.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MpiError {
    /// Several processes were started, and no library connects them.
    #[error(
        "{count} processes were started, and no MPI library with the standard ABI was found ({reason}): \
         put the folder of `libmpi_abi.so.1` into LD_LIBRARY_PATH, or its path into HELFRICH_MPI; MPICH \
         has it from version 5.0 on, and `pip install mpich` installs it"
    )]
    NoLibrary {
        /// Number of processes.
        count: usize,
        /// The last attempt.
        reason: String,
    },
    /// The library does not see the other processes.
    #[error(
        "{count} processes were started, and the MPI library {} sees one: it belongs to another MPI than the \
         program that started them; put the path of that one's `libmpi_abi.so.1` into HELFRICH_MPI",
        path.display()
    )]
    OtherLibrary {
        /// Number of processes.
        count: usize,
        /// The library.
        path: PathBuf,
    },
    /// The library has refused something.
    #[error("{function} of the MPI library failed with code {code}")]
    Failed {
        /// The function.
        function: &'static str,
        /// Its code.
        code: i32,
    },
}

/// The ranks of this run: those with which MPI has started this process, or this one alone.
///
/// To be called once, by the thread that will work. MPI ends when the team is dropped; where a thread panics, all processes
/// end.
///
/// # Errors
/// If several processes were started, and they cannot find each other.
pub fn team() -> Result<Team, MpiError> {
    let count = started();
    if count < 2 {
        return Ok(Team::alone());
    }
    Ok(Team::new(Mpi::open(count)?))
}

/// The number of processes, by what their launcher says.
fn started() -> usize {
    let sizes = SIZES
        .iter()
        .filter_map(|name| env::var(name).ok()?.parse().ok());
    sizes.max().unwrap_or(1)
}

/// The functions of MPI.
#[derive(Debug)]
struct Mpi {
    /// Never closed: MPI libraries have threads and handlers of their own until the process ends.
    opened: ManuallyDrop<Library>,
    number: usize,
    count: usize,
}

type InitThread = unsafe extern "C" fn(*mut c_int, *mut c_void, c_int, *mut c_int) -> c_int;
type Asked = unsafe extern "C" fn(Handle, *mut c_int) -> c_int;
type Send = unsafe extern "C" fn(*const c_void, Count, Handle, c_int, c_int, Handle) -> c_int;
type Receive =
    unsafe extern "C" fn(*mut c_void, Count, Handle, c_int, c_int, Handle, *mut c_void) -> c_int;
type SendReceive = unsafe extern "C" fn(
    *const c_void,
    Count,
    Handle,
    c_int,
    c_int,
    *mut c_void,
    Count,
    Handle,
    c_int,
    c_int,
    Handle,
    *mut c_void,
) -> c_int;
type Abort = unsafe extern "C" fn(Handle, c_int) -> c_int;
type Finalize = unsafe extern "C" fn() -> c_int;

impl Mpi {
    fn open(count: usize) -> Result<Self, MpiError> {
        let started = count;
        let reason = |reason| MpiError::NoLibrary { count, reason };
        let (path, library) = find().map_err(reason)?;
        let mut found = Self {
            opened: ManuallyDrop::new(library),
            number: 0,
            count: 1,
        };
        let [mut provided, mut number, mut count] = [0; 3];
        let init: Symbol<'_, InitThread> = found.function(b"MPI_Init_thread\0")?;
        // SAFETY: the signature is the standard's; the first two arguments may be null.
        let code = unsafe { init(null_mut(), null_mut(), FUNNELED, &mut provided) };
        checked("MPI_Init_thread", code)?;
        for (name, value) in [
            (&b"MPI_Comm_rank\0"[..], &mut number),
            (&b"MPI_Comm_size\0"[..], &mut count),
        ] {
            let asked: Symbol<'_, Asked> = found.function(name)?;
            // SAFETY: the signature is the standard's, MPI has been started, and the number is written before it is read.
            checked("MPI_Comm_rank", unsafe { asked(WORLD as Handle, value) })?;
        }
        (found.number, found.count) = (number as usize, count as usize);
        if found.count == 1 {
            let count = started;
            return Err(MpiError::OtherLibrary { count, path });
        }
        found.end_all_at_panics()?;
        Ok(found)
    }

    fn function<F>(&self, name: &'static [u8]) -> Result<Symbol<'_, F>, MpiError> {
        // SAFETY: all types above are those of the standard.
        unsafe { self.opened.get(name) }.map_err(|error| MpiError::NoLibrary {
            count: started(),
            reason: error.to_string(),
        })
    }

    /// Other ranks would wait forever for one that has panicked.
    fn end_all_at_panics(&self) -> Result<(), MpiError> {
        let abort: Abort = *self.function::<Abort>(b"MPI_Abort\0")?;
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            before(panic);
            // SAFETY: the signature is the standard's, and the library is not closed while threads can panic.
            unsafe { abort(WORLD as Handle, 101) };
            process::abort();
        }));
        Ok(())
    }

    /// Checks the result of a call; MPI itself ends all processes at most errors, and the others leave no way to go on.
    fn must(&self, function: &'static str, code: Result<c_int, MpiError>) {
        let done = code.and_then(|code| checked(function, code));
        done.unwrap_or_else(|error| panic!("rank {}: {error}", self.number));
    }
}

fn checked(function: &'static str, code: c_int) -> Result<(), MpiError> {
    match code {
        0 => Ok(()),
        code => Err(MpiError::Failed { function, code }),
    }
}

/// The library at the path of [`VARIABLE`], where the system looks for libraries, or beside the launcher.
fn find() -> Result<(PathBuf, Library), String> {
    let named = env::var_os(VARIABLE).map(PathBuf::from);
    let usual = LIBRARIES.iter().map(PathBuf::from);
    let beside = launchers().into_iter().filter_map(|launcher| {
        let folder = launcher
            .canonicalize()
            .ok()?
            .parent()?
            .parent()?
            .join("lib");
        Some(LIBRARIES.iter().map(move |name| folder.join(name)))
    });
    let mut last = String::new();
    for path in named.into_iter().chain(usual).chain(beside.flatten()) {
        // SAFETY: what the user has named so, or the system calls so, is an MPI library, whose start has no conditions.
        match unsafe { Library::new(&path) } {
            Ok(library) => return Ok((path, library)),
            Err(error) => {
                let reason = error
                    .source()
                    .map_or(error.to_string(), ToString::to_string);
                last = format!("{}: {reason}", path.display());
            }
        }
    }
    Err(last)
}

/// Programs that may have started this one: its parent, where the system tells, and the first `mpiexec` of the path.
fn launchers() -> Vec<PathBuf> {
    #[cfg(unix)]
    let parent = std::fs::read_link(format!("/proc/{}/exe", std::os::unix::process::parent_id()));
    #[cfg(not(unix))]
    let parent = std::io::Result::<PathBuf>::Err(std::io::ErrorKind::Unsupported.into());
    let path = env::var_os("PATH").unwrap_or_default();
    let in_path = env::split_paths(&path).map(|folder| folder.join("mpiexec"));
    let in_path = in_path.filter(|launcher| launcher.exists()).take(1);
    parent.into_iter().chain(in_path).collect()
}

fn length(bytes: &[u8]) -> Count {
    bytes.len() as Count
}

impl Ranks for Mpi {
    fn number(&self) -> usize {
        self.number
    }

    fn count(&self) -> usize {
        self.count
    }

    fn send(&self, to: usize, bytes: &[u8]) {
        let sent = self.function::<Send>(b"MPI_Send_c\0").map(|send| {
            let (data, count) = (bytes.as_ptr().cast(), length(bytes));
            // SAFETY: the pointer and the length are those of a slice, which outlives the call.
            unsafe {
                send(
                    data,
                    count,
                    BYTE as Handle,
                    to as c_int,
                    TAG,
                    WORLD as Handle,
                )
            }
        });
        self.must("MPI_Send_c", sent);
    }

    fn receive(&self, from: usize, bytes: &mut [u8]) {
        let received = self.function::<Receive>(b"MPI_Recv_c\0").map(|receive| {
            let (count, data) = (length(bytes), bytes.as_mut_ptr().cast());
            let (from, world) = (from as c_int, WORLD as Handle);
            // SAFETY: the pointer and the length are those of a slice that nobody else uses; null is MPI_STATUS_IGNORE.
            unsafe { receive(data, count, BYTE as Handle, from, TAG, world, null_mut()) }
        });
        self.must("MPI_Recv_c", received);
    }

    fn exchange(&self, to: usize, sent: &[u8], from: usize, received: &mut [u8]) {
        let done = self
            .function::<SendReceive>(b"MPI_Sendrecv_c\0")
            .map(|exchange| {
                // SAFETY: pointers and lengths are those of two slices, one of which nobody else uses.
                unsafe {
                    exchange(
                        sent.as_ptr().cast(),
                        length(sent),
                        BYTE as Handle,
                        to as c_int,
                        TAG,
                        received.as_mut_ptr().cast(),
                        length(received),
                        BYTE as Handle,
                        from as c_int,
                        TAG,
                        WORLD as Handle,
                        null_mut(),
                    )
                }
            });
        self.must("MPI_Sendrecv_c", done);
    }
}

impl Drop for Mpi {
    fn drop(&mut self) {
        if let Ok(finalize) = self.function::<Finalize>(b"MPI_Finalize\0") {
            // SAFETY: MPI was started, and is not used any more.
            unsafe { finalize() };
        }
    }
}
