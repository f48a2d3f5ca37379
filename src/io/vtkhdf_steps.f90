!> What the two kinds of VTKHDF file, of parcels and of gas, have in common: steps in time, fields, a sidecar.
!>
!> A file is open only while a step is added, so a reader never meets a held file and a killed run leaves a whole one.
!> The bulk of a step is written by all ranks, its entries in the tables of the steps by the root alone, and last of
!> all the number of steps: an interrupted step stays invisible. While the root writes, all wait, so tables that are the
!> same are one, with a name for each place where VTK looks for it.
module vtkhdf_steps
  use agreement, only: agree
  use communicator, only: communicator_t
  use files, only: exists
  use hdf5_arrays, only: share_t, put_columns, get_columns, put_attribute
  use hdf5_file, only: hdf5_file_t, real_kind, long_kind
  use kinds, only: wp, i8
  use outcome, only: outcome_t
  use provenance, only: provenance_t, put_provenance
  use timing, only: wall_seconds
  implicit none
  private
  public :: vtkhdf_t, field_t, put_row, whole

  integer, parameter :: name_length = 32
  integer(i8), parameter :: rows_of_chunk = 256      !< of the tables with a row per step
  real(wp), parameter :: sidecar_seconds = 10.0_wp   !< of wall time, between two writings of the sidecar

  type :: field_t
    character(len=name_length) :: name
    integer :: components   !< 1 or 3
    integer :: kind         !< single_kind, long_kind or integer_kind
  end type field_t

  type :: vtkhdf_t
    type(communicator_t) :: comm
    character(len=:), allocatable :: name              !< of the file
    type(hdf5_file_t) :: file                          !< open while a step is added
    integer :: steps = 0                               !< in the file
    real(wp), allocatable :: times(:)                  !< of the steps, with room for more [s]
    integer :: in_sidecar = 0                          !< steps the sidecar knows
    real(wp) :: sidecar_written = -huge(1.0_wp)        !< wall clock then [s]
    type(field_t), allocatable :: fields(:)            !< in the order of the first step
    logical :: repeated = .false.                      !< the step being added is already there
  contains
    procedure :: start
    procedure :: introduce
    procedure :: started
    procedure :: begin
    procedure :: has_field
    procedure :: close_bulk
    procedure :: make_rows
    procedure :: show_step
    procedure :: finish
    procedure :: sidecar_is_due
  end type vtkhdf_t

  !> put_row(file, path, row, values): write row `row` (from 0) of a table, which ends there.
  interface put_row
    procedure :: put_long_row, put_long_columns, put_real_row
  end interface put_row

contains

  !> Begin a new file, or go on with that of a run that is continued at the time `after`: later steps are dropped.
  !> `fresh` tells the root which; there the file is open for what its kind needs. To be ended by `started`.
  subroutine start(self, name, comm, after, fresh)
    class(vtkhdf_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    type(communicator_t), intent(in) :: comm
    real(wp), intent(in), optional :: after  !< [s]
    logical, intent(out) :: fresh

    self%comm = comm
    self%name = name
    allocate (self%fields(0))
    allocate (self%times(16), source=0.0_wp)
    fresh = .not. present(after)
    if (.not. comm%is_root()) return
    if (.not. fresh) fresh = .not. exists(name)
    if (fresh) then
      call self%file%create(name)
      return
    end if
    call self%file%open(name, .true.)
    call keep_steps(self, after)
  end subroutine start

  !> Of a new file: what VTK wants to know first, and where the result comes from.
  subroutine introduce(self, type, version, origin)
    class(vtkhdf_t), intent(inout) :: self
    character(len=*), intent(in) :: type  !< 'PolyData', 'ImageData' or 'RectilinearGrid'
    integer, intent(in) :: version(2)     !< of VTKHDF, in which it is defined
    type(provenance_t), intent(in) :: origin

    call self%file%make_group('/VTKHDF')
    call put_attribute(self%file, '/VTKHDF', 'Version', version)
    call put_attribute(self%file, '/VTKHDF', 'Type', type)
    call self%file%make('/VTKHDF/Steps/Values', real_kind, [0_i8], [rows_of_chunk])
    call put_attribute(self%file, '/VTKHDF/Steps', 'NSteps', 0)
    call put_attribute(self%file, '/VTKHDF/Steps/Values', 'unit', 's')
    call put_provenance(self%file, origin)
  end subroutine introduce

  !> Close the file the root has begun, and tell all ranks which steps it has.
  subroutine started(self, outcome)
    class(vtkhdf_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    integer :: sizes(2)

    if (self%comm%is_root()) call self%file%close(outcome)
    call agree(self%comm, outcome)
    sizes = [self%steps, size(self%times)]
    call self%comm%broadcast(sizes)
    self%steps = sizes(1)
    if (size(self%times) /= sizes(2)) self%times = spread(0.0_wp, 1, sizes(2))
    call self%comm%broadcast(self%times)
  end subroutine started

  !> Keep the steps up to the time `after`. The arrays are cut to length when the next step is added.
  subroutine keep_steps(self, after)
    type(vtkhdf_t), intent(inout) :: self
    real(wp), intent(in) :: after

    integer :: rows

    rows = int(product(self%file%shape_of('/VTKHDF/Steps/Values')))
    self%times = spread(0.0_wp, 1, rows + 16)
    call get_columns(self%file, '/VTKHDF/Steps/Values', self%times(:rows), 0_i8)
    self%steps = count(is_not_after(self%times(:rows), after))
    call put_attribute(self%file, '/VTKHDF/Steps', 'NSteps', self%steps)
    call self%file%resize('/VTKHDF/Steps/Values', int(self%steps, i8))
  end subroutine keep_steps

  !> Whether a time is not after another, but for round-off.
  elemental function is_not_after(time, other)
    real(wp), intent(in) :: time, other
    logical :: is_not_after

    is_not_after = time <= other + 1.0e-9_wp*abs(other)
  end function is_not_after

  !> Open the file on all ranks for the next step. A step the file has already is left as it is.
  subroutine begin(self, time)
    class(vtkhdf_t), intent(inout) :: self
    real(wp), intent(in) :: time  !< [s]

    self%repeated = .false.
    if (self%steps > 0) self%repeated = is_not_after(time, self%times(self%steps))
    if (self%repeated) return
    if (self%steps == size(self%times)) self%times = [self%times, 0.0_wp*self%times]
    self%times(self%steps + 1) = time
    call self%file%open(self%name, .true., self%comm)
  end subroutine begin

  !> Whether the open file has a field; the first step makes them, later ones must have the same.
  function has_field(self, folder, name, components, kind) result(known)
    class(vtkhdf_t), intent(inout) :: self
    character(len=*), intent(in) :: folder, name
    integer, intent(in) :: components, kind
    logical :: known

    integer :: i

    known = self%file%has(folder//name)
    do i = 1, size(self%fields)
      if (self%fields(i)%name == name) return
    end do
    self%fields = [self%fields, field_t(name, components, kind)]
  end function has_field

  !> Close the file on all ranks, and open it on the root for the entries of the new step.
  subroutine close_bulk(self, outcome)
    class(vtkhdf_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    call self%file%close(outcome)
    if (self%comm%is_root()) call self%file%open(self%name, .true.)
  end subroutine close_bulk

  !> On the root: a table of integers to be filled by `put_row`, and the other names it goes by.
  subroutine make_rows(self, path, names, columns)
    class(vtkhdf_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    character(len=*), intent(in), optional :: names(:)
    integer, intent(in), optional :: columns  !< absent: rows, of any length, one behind the other

    integer :: i

    if (present(columns)) then
      call self%file%make(path, long_kind, [int(columns, i8), 0_i8], [int(columns, i8), rows_of_chunk])
    else
      call self%file%make(path, long_kind, [0_i8], [rows_of_chunk])
    end if
    if (.not. present(names)) return
    do i = 1, size(names)
      call self%file%give_name(path, trim(names(i)))
    end do
  end subroutine make_rows

  !> On the root, when the entries of the step are in the tables: the offsets of all fields are those in one of them. Last the
  !> number of steps, which makes the step visible, and the file is closed.
  subroutine show_step(self, offsets, folder, outcome)
    class(vtkhdf_t), intent(inout) :: self
    character(len=*), intent(in) :: offsets  !< the table with them
    character(len=*), intent(in) :: folder   !< where VTK looks for one per field
    type(outcome_t), intent(inout) :: outcome

    integer :: i

    if (self%steps == 0) then
      do i = 1, size(self%fields)
        if (self%file%has(folder//trim(self%fields(i)%name))) cycle
        call self%file%give_name(offsets, folder//trim(self%fields(i)%name))
      end do
    end if
    call put_row(self%file, '/VTKHDF/Steps/Values', self%steps, [self%times(self%steps + 1)])
    call put_attribute(self%file, '/VTKHDF/Steps', 'NSteps', self%steps + 1)
    call self%file%close(outcome)
  end subroutine show_step

  !> The root has shown the step: it counts, and all ranks know whether that went well.
  subroutine finish(self, outcome)
    class(vtkhdf_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    self%steps = self%steps + 1
    call agree(self%comm, outcome)
  end subroutine finish

  !> Whether the root shall write the sidecar now that the file has these steps. It is a list of all steps, so it is rewritten when
  !> a twentieth of them are new, but not all the time, and at the end.
  function sidecar_is_due(self, steps, at_end) result(due)
    class(vtkhdf_t), intent(inout) :: self
    integer, intent(in) :: steps
    logical, intent(in) :: at_end
    logical :: due

    real(wp) :: now

    now = wall_seconds()
    due = at_end .or. (steps - self%in_sidecar > steps/20 .and. now - self%sidecar_written > sidecar_seconds)
    due = due .and. steps > self%in_sidecar .and. self%comm%is_root()
    if (.not. due) return
    self%in_sidecar = steps
    self%sidecar_written = now
  end function sidecar_is_due

  subroutine put_long_row(file, path, row, values)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer, intent(in) :: row
    integer(i8), intent(in), contiguous :: values(:)

    call put_columns(file, path, values, whole(size(values)), row*size(values, kind=i8))
  end subroutine put_long_row

  !> Of a table with columns.
  subroutine put_long_columns(file, path, row, values)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer, intent(in) :: row
    integer(i8), intent(in), contiguous :: values(:,:)  !< (columns, 1)

    call put_columns(file, path, values, whole(1), int(row, i8))
  end subroutine put_long_columns

  subroutine put_real_row(file, path, row, values)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer, intent(in) :: row
    real(wp), intent(in), contiguous :: values(:)

    call put_columns(file, path, values, whole(size(values)), row*size(values, kind=i8))
  end subroutine put_real_row

  !> The share of a rank that has all n columns.
  pure function whole(n) result(share)
    integer, intent(in) :: n
    type(share_t) :: share

    share = share_t(n, 0, n)
  end function whole

end module vtkhdf_steps
