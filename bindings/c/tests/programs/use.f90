! Use of the C interface from Fortran: arrays of points are (3, n), as in memory.
program use
  use, intrinsic :: iso_c_binding
  implicit none

  type, bind(c) :: hf_error
    integer(c_int) :: status
    character(kind=c_char) :: text(1020)
  end type

  interface
    integer(c_int) function hf_mesh_read(path, weld, mesh, error) bind(c)
      import
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int32_t), value :: weld
      type(c_ptr), intent(out) :: mesh
      type(hf_error), intent(out) :: error
    end function
    integer(c_size_t) function hf_mesh_vertex_count(mesh) bind(c)
      import
      type(c_ptr), value :: mesh
    end function
    integer(c_int) function hf_mesh_positions(mesh, positions, count, error) bind(c)
      import
      type(c_ptr), value :: mesh
      real(c_double), intent(out) :: positions(3, *)
      integer(c_size_t), value :: count
      type(hf_error), intent(out) :: error
    end function
    integer(c_int) function hf_membrane_new(mesh, reference, count, effects, values, value_count, threads, &
                                            membrane, error) bind(c)
      import
      type(c_ptr), value :: mesh
      real(c_double), intent(in) :: reference(3, *)
      integer(c_size_t), value :: count
      character(kind=c_char), intent(in) :: effects(*)
      type(c_ptr), value :: values
      integer(c_size_t), value :: value_count, threads
      type(c_ptr), intent(out) :: membrane
      type(hf_error), intent(out) :: error
    end function
    integer(c_int) function hf_membrane_force(membrane, positions, count, force, energy, error) bind(c)
      import
      type(c_ptr), value :: membrane
      real(c_double), intent(in) :: positions(3, *)
      integer(c_size_t), value :: count
      real(c_double), intent(out) :: force(3, *), energy
      type(hf_error), intent(out) :: error
    end function
    subroutine hf_membrane_free(membrane) bind(c)
      import
      type(c_ptr), value :: membrane
    end subroutine
    subroutine hf_mesh_free(mesh) bind(c)
      import
      type(c_ptr), value :: mesh
    end subroutine
  end interface

  real(c_double), parameter :: pi = acos(-1.0_c_double)
  type(hf_error) :: error
  type(c_ptr) :: mesh, membrane
  integer(c_size_t) :: n
  real(c_double), allocatable :: x(:, :), force(:, :)
  real(c_double) :: energy
  character(len=1000) :: path

  call get_command_argument(1, path)
  call check(hf_mesh_read(trim(path)//c_null_char, 0_c_int32_t, mesh, error))
  n = hf_mesh_vertex_count(mesh)
  allocate (x(3, n), force(3, n))
  call check(hf_mesh_positions(mesh, x, n, error))
  call check(hf_membrane_new(mesh, x, n, 'bending = { method = "j6", modulus = 2.0 }'//c_null_char, c_null_ptr, &
                             0_c_size_t, 1_c_size_t, membrane, error))
  call check(hf_membrane_force(membrane, x, n, force, energy, error))
  ! E = 8 pi kappa, with the areas of triangles.
  if (abs(energy/(16*pi) - 1) > 1e-2) error stop 'the energy is not that of a sphere'
  if (maxval(abs(sum(force, 2))) > 1e-9) error stop 'forces do not sum to zero'
  call hf_membrane_free(membrane)
  call hf_mesh_free(mesh)

contains

  subroutine check(status)
    integer(c_int), intent(in) :: status
    if (status /= 0) then
      print *, error%text
      error stop
    end if
  end subroutine
end program
