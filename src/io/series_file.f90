!> Tables of numbers against time, monitor.h5: one group per table, one dataset per column, each with unit and meaning.
!>
!>   call series%open(name, comm, origin, outcome, after)
!>   call series%add_table('/series', [column_t('pressure_drop', 'Pa', 'between the lowest and highest cells')], table)
!>   call series%append(table, time, [123.0_wp])
!>   call series%flush(outcome)         collective; done from time to time by itself, on the root
!>   call series%close(outcome)
!>
!> All ranks may call; the root alone writes. Rows are gathered in memory, and the file is open only while they are
!> added. So a script may read it at any time, and a killed run leaves a whole file. HDF5's own way of reading beside
!> a writer (SWMR) gives neither: a killed writer's file opens only after a repair with h5clear.
module series_file
  use, intrinsic :: iso_c_binding, only: c_loc
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use agreement, only: agree
  use communicator, only: communicator_t
  use files, only: exists
  use hdf5_arrays, only: share_t, put_columns, get_columns, put_attribute
  use hdf5_file, only: hdf5_file_t, real_kind
  use kinds, only: wp, i8
  use outcome, only: outcome_t
  use provenance, only: provenance_t, put_provenance
  use timing, only: wall_seconds
  implicit none
  private
  public :: series_file_t, column_t

  integer, parameter :: path_length = 64
  integer, parameter :: rows_in_memory = 500            !< at most
  integer(i8), parameter :: rows_of_chunk = 1024
  real(wp), parameter :: seconds_in_memory = 2.0_wp     !< of wall time; then rows are written

  type :: column_t
    character(len=32) :: name
    character(len=12) :: unit
    character(len=100) :: meaning
    integer :: components = 1   !< 3 for a vector
    integer :: places = 1       !< more than one for a profile
  end type column_t

  type :: table_t
    character(len=path_length) :: path
    type(column_t), allocatable :: columns(:)
    integer(i8) :: rows = 0                      !< in the file
    integer :: waiting = 0                       !< rows in memory
    real(wp) :: last = -huge(1.0_wp)             !< time of the last row [s]
    real(wp), allocatable :: times(:)            !< of the rows in memory [s]
    real(wp), allocatable :: values(:,:)         !< (all columns side by side, row) in memory
  end type table_t

  type :: series_file_t
    private
    type(communicator_t) :: comm
    character(len=:), allocatable :: name
    type(table_t), allocatable :: tables(:)
    real(wp) :: written = 0.0_wp                 !< wall clock when rows were last written [s]
    logical :: continued = .false.               !< whether the file has rows of a run before
    real(wp) :: after                            !< the time up to which they count [s]
    type(outcome_t) :: outcome                   !< of the root
  contains
    procedure :: open => open_series
    procedure :: add_table
    procedure :: annotate
    procedure :: append
    procedure :: flush => flush_series
    procedure :: close => close_series
  end type series_file_t

contains

  !> Begin the file, or go on with that of the run which is continued at the time `after`.
  subroutine open_series(self, name, comm, origin, outcome, after)
    class(series_file_t), intent(out) :: self
    character(len=*), intent(in) :: name
    type(communicator_t), intent(in) :: comm
    type(provenance_t), intent(in) :: origin
    type(outcome_t), intent(inout) :: outcome
    real(wp), intent(in), optional :: after   !< [s]

    type(hdf5_file_t) :: file

    self%name = name
    self%comm = comm
    self%after = 0.0_wp
    self%written = wall_seconds()
    allocate (self%tables(0))
    if (comm%is_root()) then
      if (present(after)) self%continued = exists(name)
      if (present(after)) self%after = after
      if (.not. self%continued) then
        call file%create(name)
        call put_provenance(file, origin)
        call file%close(self%outcome)
      end if
    end if
    call self%flush(outcome)
  end subroutine open_series

  !> A new table; of a continued file, the one of that name, whose later rows are dropped.
  subroutine add_table(self, path, columns, table)
    class(series_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path          !< such as '/series' or '/monitors/name'
    type(column_t), intent(in) :: columns(:)      !< beside `time`
    integer, intent(out) :: table                 !< to append with

    type(table_t) :: new
    type(hdf5_file_t) :: file
    integer :: c

    new%path = path
    new%columns = columns
    allocate (new%times(rows_in_memory), source=0.0_wp)
    allocate (new%values(sum(width(columns)), rows_in_memory), source=0.0_wp)
    table = size(self%tables) + 1
    if (self%comm%is_root()) then
      call file%open(self%name, .true.)
      if (file%has(path//'/time')) call keep_rows(self, file, new)
      call make_column(file, path, column_t('time', 's', 'simulated time'), new%rows)
      do c = 1, size(columns)
        call make_column(file, path, columns(c), new%rows)
      end do
      call file%close(self%outcome)
    end if
    self%tables = [self%tables, new]
  end subroutine add_table

  !> Numbers of a column in one row.
  elemental function width(column)
    type(column_t), intent(in) :: column
    integer :: width

    width = column%components*column%places
  end function width

  !> The dimensions of a column before that of the rows.
  pure function lead_of(column) result(lead)
    type(column_t), intent(in) :: column
    integer(i8), allocatable :: lead(:)

    lead = pack([column%components, column%places], [column%components, column%places] > 1)
  end function lead_of

  !> Find out how many rows of a continued file count.
  subroutine keep_rows(self, file, table)
    class(series_file_t), intent(in) :: self
    type(hdf5_file_t), intent(inout) :: file
    type(table_t), intent(inout) :: table

    real(wp), allocatable :: times(:)

    allocate (times(product(file%shape_of(trim(table%path)//'/time'))), source=0.0_wp)
    call get_columns(file, trim(table%path)//'/time', times, 0_i8)
    table%rows = count(times <= self%after + 1.0e-9_wp*abs(self%after))
    if (table%rows > 0) table%last = times(table%rows)
  end subroutine keep_rows

  !> A column with `rows` rows: the first ones of what is there, or filled with "not a number" if it is new.
  subroutine make_column(file, path, column, rows)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    type(column_t), intent(in) :: column
    integer(i8), intent(in) :: rows

    character(len=:), allocatable :: name
    real(wp), allocatable, target :: nothing(:,:)

    name = path//'/'//trim(column%name)
    if (file%has(name)) then
      call file%resize(name, rows)
      return
    end if
    associate (lead => lead_of(column))
      call file%make(name, real_kind, [lead, rows], [lead, rows_of_chunk/width(column) + 1])
      call put_attribute(file, name, 'unit', trim(column%unit))
      call put_attribute(file, name, 'meaning', trim(column%meaning))
      if (rows == 0) return
      allocate (nothing(width(column), rows), source=ieee_value(1.0_wp, ieee_quiet_nan))
      call file%write(name, real_kind, c_loc(nothing), 0*[lead, rows], [lead, rows])
    end associate
  end subroutine make_column

  !> Say more about a table: a text, or numbers (3,n) that do not change, such as the places of a profile.
  subroutine annotate(self, table, name, text, numbers, unit)
    class(series_file_t), intent(inout) :: self
    integer, intent(in) :: table
    character(len=*), intent(in) :: name
    character(len=*), intent(in), optional :: text, unit
    real(wp), intent(in), contiguous, optional :: numbers(:,:)

    type(hdf5_file_t) :: file
    character(len=:), allocatable :: path
    logical :: known

    if (.not. self%comm%is_root()) return
    call file%open(self%name, .true.)
    path = trim(self%tables(table)%path)
    if (present(text)) call put_attribute(file, path, name, text)
    path = path//'/'//name
    known = file%has(path)
    if (present(numbers) .and. .not. known) then
      call file%make(path, real_kind, shape(numbers, i8))
      call put_columns(file, path, numbers, share_t(size(numbers, 2), 0, size(numbers, 2)))
      call put_attribute(file, path, 'unit', unit)
    end if
    call file%close(self%outcome)
  end subroutine annotate

  !> Add a row. A time that the table has already is ignored.
  subroutine append(self, table, time, values)
    class(series_file_t), intent(inout) :: self
    integer, intent(in) :: table
    real(wp), intent(in) :: time       !< [s]
    real(wp), intent(in) :: values(:)  !< all columns side by side

    if (.not. self%comm%is_root()) return
    associate (t => self%tables(table))
      if (size(values) /= size(t%values, 1)) error stop 'series_file: a row does not fit its table'
      if (time <= t%last + 1.0e-9_wp*abs(t%last)) return
      if (t%waiting == rows_in_memory) call write_rows(self)
      t%last = time
      t%waiting = t%waiting + 1
      t%times(t%waiting) = time
      t%values(:, t%waiting) = values
    end associate
    if (wall_seconds() - self%written > seconds_in_memory) call write_rows(self)
  end subroutine append

  !> Bring all rows into the file.
  subroutine write_rows(self)
    class(series_file_t), intent(inout) :: self

    type(hdf5_file_t) :: file
    integer :: i

    self%written = wall_seconds()
    if (sum(self%tables%waiting) == 0) return
    call file%open(self%name, .true.)
    do i = 1, size(self%tables)
      if (self%tables(i)%waiting > 0) call write_table(file, self%tables(i))
    end do
    call file%close(self%outcome)
  end subroutine write_rows

  !> The times are written last; rows that lack one do not count.
  subroutine write_table(file, table)
    type(hdf5_file_t), intent(inout) :: file
    type(table_t), intent(inout) :: table

    integer :: c, first, last
    integer(i8) :: n
    real(wp), allocatable, target :: values(:,:)
    character(len=:), allocatable :: name

    n = table%waiting
    last = 0
    do c = 1, size(table%columns)
      first = last + 1
      last = last + width(table%columns(c))
      name = trim(table%path)//'/'//trim(table%columns(c)%name)
      allocate (values(last - first + 1, n), source=table%values(first:last, :n))
      call file%resize(name, table%rows + n)
      associate (lead => lead_of(table%columns(c)))
        call file%write(name, real_kind, c_loc(values), [0*lead, table%rows], [lead, n])
      end associate
      deallocate (values)
    end do
    call put_columns(file, trim(table%path)//'/time', table%times(:n), share_t(n, 0, n), table%rows)
    table%rows = table%rows + n
    table%waiting = 0
  end subroutine write_table

  !> Bring all rows into the file, and let all ranks know if that failed, now or before.
  subroutine flush_series(self, outcome)
    class(series_file_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    if (self%comm%is_root()) call write_rows(self)
    if (self%outcome%failed()) call outcome%fail(self%outcome%code, self%outcome%message)
    call agree(self%comm, outcome)
  end subroutine flush_series

  subroutine close_series(self, outcome)
    class(series_file_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    call self%flush(outcome)
  end subroutine close_series

end module series_file
