!> The restart file: everything a run needs to go on exactly as if it had never stopped.
!>
!>   call writer%create(name, comm, time, origin)
!>   call writer%add('state', state)                        my columns, any number of arrays
!>   call writer%add_field('pressure', p, lower, extent)    my block of a grid
!>   call writer%add_copy('step', [step])                   the same on all ranks
!>   call writer%finish(outcome)
!>
!> The file is written under another name and takes its place only when it is whole and on the disk; the one before
!> is kept as NAME.prev. On the number of ranks that wrote it every rank reads exactly its own columns, in their
!> order; on another number the columns are dealt out in equal runs.
module restart_file
  use agreement, only: agree
  use communicator, only: communicator_t
  use files, only: replace_file
  use hdf5_arrays, only: share_t, share_of, share_of_root, put_columns, get_columns, put_block, get_block, &
    put_attribute, get_attribute
  use hdf5_file, only: hdf5_file_t, real_kind, long_kind, integer_kind
  use kinds, only: wp, i8
  use outcome, only: outcome_t, exit_input
  use provenance, only: provenance_t, put_provenance
  implicit none
  private
  public :: restart_writer_t, restart_reader_t

  integer, parameter :: format = 3  !< of this file and those a continued run adds to; a program refuses those it does not know

  integer(i8), parameter :: alone(0) = 0_i8  !< no dimension before that of the columns

  type :: restart_writer_t
    private
    type(communicator_t) :: comm
    character(len=:), allocatable :: name
    type(hdf5_file_t) :: file
    type(share_t) :: share                !< of the array being written
  contains
    procedure :: create
    procedure, private :: add_reals, add_vectors, add_longs, add_long_vectors, add_integers, add_integer_vectors
    generic :: add => add_reals, add_vectors, add_longs, add_long_vectors, add_integers, add_integer_vectors
    procedure :: add_field
    procedure, private :: copy_reals, copy_integers
    generic :: add_copy => copy_reals, copy_integers
    procedure :: finish
  end type restart_writer_t

  type :: restart_reader_t
    real(wp) :: time = 0.0_wp             !< at which the file was written [s]
    integer :: ranks = 0                  !< that wrote it
    type(communicator_t), private :: comm
    type(hdf5_file_t), private :: file
  contains
    procedure :: open => open_restart
    procedure :: has
    procedure, private :: get_reals, get_vectors, get_longs, get_long_vectors, get_integers, get_integer_vectors
    generic :: get => get_reals, get_vectors, get_longs, get_long_vectors, get_integers, get_integer_vectors
    procedure :: get_field
    procedure :: field_shape
    procedure, private :: get_copy_reals, get_copy_integers
    generic :: get_copy => get_copy_reals, get_copy_integers
    procedure :: close => close_restart
  end type restart_reader_t

contains

  !> Begin a restart file.
  subroutine create(self, name, comm, time, origin)
    class(restart_writer_t), intent(out) :: self
    character(len=*), intent(in) :: name
    type(communicator_t), intent(in) :: comm
    real(wp), intent(in) :: time            !< [s]
    type(provenance_t), intent(in) :: origin

    self%name = name
    self%comm = comm
    call self%file%create(name//'.tmp', comm)
    call put_provenance(self%file, origin)
    call put_attribute(self%file, '/geldart', 'format', format)
    call put_attribute(self%file, '/geldart', 'ranks', comm%size)
    call put_attribute(self%file, '/geldart', 'time', time)
  end subroutine create

  !> Make the dataset of a distributed array, and note how many columns each rank has.
  subroutine begin_columns(self, name, kind, lead, columns)
    class(restart_writer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: kind
    integer(i8), intent(in) :: lead(:)   !< the dimension before that of the columns, if there is one
    integer, intent(in) :: columns

    self%share = share_of(self%comm, columns)
    call self%file%make('/columns/'//name, integer_kind, [int(self%comm%size, i8)])
    call put_columns(self%file, '/columns/'//name, [columns], share_of(self%comm, 1))
    call self%file%make('/'//name, kind, [lead, self%share%total])
  end subroutine begin_columns

  subroutine add_reals(self, name, x)
    class(restart_writer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), intent(in), contiguous :: x(:)

    call begin_columns(self, name, real_kind, alone, size(x, 1))
    call put_columns(self%file, '/'//name, x, self%share)
  end subroutine add_reals

  subroutine add_vectors(self, name, x)
    class(restart_writer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), intent(in), contiguous :: x(:,:)

    call begin_columns(self, name, real_kind, [size(x, 1, i8)], size(x, 2))
    call put_columns(self%file, '/'//name, x, self%share)
  end subroutine add_vectors

  subroutine add_longs(self, name, x)
    class(restart_writer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(i8), intent(in), contiguous :: x(:)

    call begin_columns(self, name, long_kind, alone, size(x, 1))
    call put_columns(self%file, '/'//name, x, self%share)
  end subroutine add_longs

  subroutine add_long_vectors(self, name, x)
    class(restart_writer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(i8), intent(in), contiguous :: x(:,:)

    call begin_columns(self, name, long_kind, [size(x, 1, i8)], size(x, 2))
    call put_columns(self%file, '/'//name, x, self%share)
  end subroutine add_long_vectors

  subroutine add_integers(self, name, x)
    class(restart_writer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in), contiguous :: x(:)

    call begin_columns(self, name, integer_kind, alone, size(x, 1))
    call put_columns(self%file, '/'//name, x, self%share)
  end subroutine add_integers

  subroutine add_integer_vectors(self, name, x)
    class(restart_writer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in), contiguous :: x(:,:)

    call begin_columns(self, name, integer_kind, [size(x, 1, i8)], size(x, 2))
    call put_columns(self%file, '/'//name, x, self%share)
  end subroutine add_integer_vectors

  !> My block of a field on a grid. Blocks of different ranks must not overlap.
  subroutine add_field(self, name, f, lower, extent)
    class(restart_writer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), intent(in), contiguous :: f(:,:,:)
    integer, intent(in) :: lower(3)   !< place of f(1,1,1) in the whole grid, from 1
    integer, intent(in) :: extent(3)  !< of the whole grid

    call self%file%make('/'//name, real_kind, int(extent, i8))
    call put_block(self%file, '/'//name, f, lower)
  end subroutine add_field

  subroutine copy_reals(self, name, x)
    class(restart_writer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), intent(in), contiguous :: x(:)

    call self%file%make('/'//name, real_kind, [size(x, kind=i8)])
    call put_columns(self%file, '/'//name, x, share_of_root(self%comm, size(x)))
  end subroutine copy_reals

  subroutine copy_integers(self, name, x)
    class(restart_writer_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in), contiguous :: x(:)

    call self%file%make('/'//name, integer_kind, [size(x, kind=i8)])
    call put_columns(self%file, '/'//name, x, share_of_root(self%comm, size(x)))
  end subroutine copy_integers

  !> Complete the file and put it in its place.
  subroutine finish(self, outcome)
    class(restart_writer_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    call self%file%close(outcome)
    if (outcome%failed()) return
    if (self%comm%is_root()) call replace_file(self%name//'.tmp', self%name, self%name//'.prev', outcome)
    call agree(self%comm, outcome)
  end subroutine finish

  !> Open a restart file to go on from.
  subroutine open_restart(self, name, comm, outcome)
    class(restart_reader_t), intent(out) :: self
    character(len=*), intent(in) :: name
    type(communicator_t), intent(in) :: comm
    type(outcome_t), intent(inout) :: outcome

    integer :: written_as

    self%comm = comm
    written_as = 0
    call self%file%open(name, .false., comm)
    call get_attribute(self%file, '/geldart', 'format', written_as)
    call get_attribute(self%file, '/geldart', 'ranks', self%ranks)
    call get_attribute(self%file, '/geldart', 'time', self%time)
    if (self%file%failed()) call self%file%close(outcome)
    if (outcome%failed()) return
    if (written_as /= format) call outcome%fail(exit_input, "'"//name// &
      "' is a restart file of another version of this program: continue it with the one that wrote it")
  end subroutine open_restart

  !> Whether the file has an array of this name.
  function has(self, name)
    class(restart_reader_t), intent(in) :: self
    character(len=*), intent(in) :: name
    logical :: has

    has = self%file%has('/'//name)
  end function has

  !> Which columns of a distributed array are mine.
  subroutine find_columns(self, name, rows, columns, first, wanted)
    class(restart_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(out) :: rows      !< in a column
    integer, intent(out) :: columns   !< that are mine
    integer(i8), intent(out) :: first  !< how many come before them
    integer, intent(in), optional :: wanted  !< how many are to be mine, all of them together being shared out

    integer :: counts(0:self%ranks - 1)
    integer(i8) :: total

    associate (extent => self%file%shape_of('/'//name), rank => self%comm%rank)
      total = extent(size(extent))
      rows = int(product(extent(:size(extent) - 1)))
      counts = 0
      call get_columns(self%file, '/columns/'//name, counts, 0_i8)
      if (present(wanted)) then
        columns = wanted
        first = self%comm%before(int(wanted, i8))
      else if (self%ranks == self%comm%size) then
        first = sum(int(counts(:rank - 1), i8))
        columns = counts(rank)
      else
        first = total*rank/self%comm%size
        columns = int(total*(rank + 1)/self%comm%size - first)
      end if
    end associate
  end subroutine find_columns

  subroutine get_reals(self, name, x)
    class(restart_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), allocatable, intent(out) :: x(:)

    integer :: rows, columns
    integer(i8) :: first

    call find_columns(self, name, rows, columns, first)
    allocate (x(columns), source=0.0_wp)
    call get_columns(self%file, '/'//name, x, first)
  end subroutine get_reals

  subroutine get_vectors(self, name, x, columns)
    class(restart_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), allocatable, intent(out) :: x(:,:)
    integer, intent(in), optional :: columns  !< that are mine; else as they were written, or equal runs

    integer :: rows, mine
    integer(i8) :: first

    call find_columns(self, name, rows, mine, first, columns)
    allocate (x(rows, mine), source=0.0_wp)
    call get_columns(self%file, '/'//name, x, first)
  end subroutine get_vectors

  subroutine get_longs(self, name, x, columns)
    class(restart_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(i8), allocatable, intent(out) :: x(:)
    integer, intent(in), optional :: columns  !< that are mine; else as they were written, or equal runs

    integer :: rows, mine
    integer(i8) :: first

    call find_columns(self, name, rows, mine, first, columns)
    allocate (x(mine), source=0_i8)
    call get_columns(self%file, '/'//name, x, first)
  end subroutine get_longs

  subroutine get_long_vectors(self, name, x)
    class(restart_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer(i8), allocatable, intent(out) :: x(:,:)

    integer :: rows, columns
    integer(i8) :: first

    call find_columns(self, name, rows, columns, first)
    allocate (x(rows, columns), source=0_i8)
    call get_columns(self%file, '/'//name, x, first)
  end subroutine get_long_vectors

  subroutine get_integers(self, name, x)
    class(restart_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, allocatable, intent(out) :: x(:)

    integer :: rows, columns
    integer(i8) :: first

    call find_columns(self, name, rows, columns, first)
    allocate (x(columns), source=0)
    call get_columns(self%file, '/'//name, x, first)
  end subroutine get_integers

  subroutine get_integer_vectors(self, name, x)
    class(restart_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, allocatable, intent(out) :: x(:,:)

    integer :: rows, columns
    integer(i8) :: first

    call find_columns(self, name, rows, columns, first)
    allocate (x(rows, columns), source=0)
    call get_columns(self%file, '/'//name, x, first)
  end subroutine get_integer_vectors

  !> My block of a field: as many cells as f has.
  subroutine get_field(self, name, f, lower)
    class(restart_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), intent(inout), contiguous :: f(:,:,:)
    integer, intent(in) :: lower(3)   !< place of f(1,1,1) in the whole grid, from 1

    call get_block(self%file, '/'//name, f, lower)
  end subroutine get_field

  !> Cells of a field in each direction.
  function field_shape(self, name) result(cells)
    class(restart_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer :: cells(3)

    cells = int(self%file%shape_of('/'//name))
  end function field_shape

  subroutine get_copy_reals(self, name, x)
    class(restart_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), allocatable, intent(out) :: x(:)

    allocate (x(product(self%file%shape_of('/'//name))), source=0.0_wp)
    call get_columns(self%file, '/'//name, x, 0_i8)
  end subroutine get_copy_reals

  subroutine get_copy_integers(self, name, x)
    class(restart_reader_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, allocatable, intent(out) :: x(:)

    allocate (x(product(self%file%shape_of('/'//name))), source=0)
    call get_columns(self%file, '/'//name, x, 0_i8)
  end subroutine get_copy_integers

  !> Close the file, and tell whether all of it could be read.
  subroutine close_restart(self, outcome)
    class(restart_reader_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    call self%file%close(outcome)
  end subroutine close_restart

end module restart_file
