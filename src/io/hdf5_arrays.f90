!> Arrays and attributes in HDF5 files: one call for every type and shape the program has.
!>
!> A distributed array is one dataset to which every rank gives its columns, in the order of the ranks, or its block
!> of the grid. A vector per column or cell comes first: x(3,n), u(3,i,j,k).
module hdf5_arrays
  use, intrinsic :: iso_c_binding, only: c_ptr, c_loc
  use communicator, only: communicator_t
  use hdf5_file, only: hdf5_file_t, real_kind, single_kind, long_kind, integer_kind, text_kind
  use kinds, only: wp, sp, i8
  implicit none
  private
  public :: share_t, share_of, share_of_root, put_columns, get_columns, put_block, get_block, put_attribute, get_attribute

  integer(i8), parameter :: alone(0) = 0_i8  !< no dimension before that of the columns

  !> How the columns of an array are shared out: mine come after `before` others, of `total`.
  type :: share_t
    integer(i8) :: mine = 0, before = 0, total = 0
  end type share_t

  !> put_columns(file, path, x, share, first): write my columns behind the `first` ones of a dataset, which grows or
  !> shrinks to first + share%total columns if it can.
  interface put_columns
    procedure :: put_reals, put_vectors, put_singles, put_single_vectors, put_longs, put_long_vectors, put_integers, &
      put_integer_vectors
  end interface put_columns

  !> get_columns(file, path, x, first): read as many columns as x has, after the `first` ones.
  interface get_columns
    procedure :: get_reals, get_vectors, get_longs, get_long_vectors, get_integers, get_integer_vectors
  end interface get_columns

  !> put_block(file, path, f, lower, step): write the cells of f, the first of which is cell `lower` (from 1) of the
  !> dataset's grid; as its time step `step` (from 0) if it has such a dimension.
  interface put_block
    procedure :: put_real_block, put_real_vector_block, put_single_block, put_single_vector_block
  end interface put_block

  interface get_block
    procedure :: get_real_block
  end interface get_block

  interface put_attribute
    procedure :: put_text_attribute, put_real_attribute, put_reals_attribute, put_integer_attribute, &
      put_integers_attribute
  end interface put_attribute

  interface get_attribute
    procedure :: get_real_attribute, get_integer_attribute
  end interface get_attribute

contains

  !> The share of this rank when each has some columns.
  function share_of(comm, columns) result(share)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: columns  !< that this rank has
    type(share_t) :: share

    share%mine = columns
    share%before = comm%before(share%mine)
    share%total = comm%sum(share%mine)
  end function share_of

  !> The share of this rank when the root has all columns.
  function share_of_root(comm, columns) result(share)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: columns  !< the same on all ranks
    type(share_t) :: share

    share%total = columns
    share%mine = merge(columns, 0, comm%is_root())
  end function share_of_root

  subroutine put_reals(file, path, x, share, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(wp), intent(in), target, contiguous :: x(:)
    type(share_t), intent(in) :: share
    integer(i8), intent(in), optional :: first

    call put(file, path, real_kind, c_loc(x), alone, share, first)
  end subroutine put_reals

  subroutine put_vectors(file, path, x, share, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(wp), intent(in), target, contiguous :: x(:,:)
    type(share_t), intent(in) :: share
    integer(i8), intent(in), optional :: first

    call put(file, path, real_kind, c_loc(x), [size(x, 1, i8)], share, first)
  end subroutine put_vectors

  subroutine put_singles(file, path, x, share, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(sp), intent(in), target, contiguous :: x(:)
    type(share_t), intent(in) :: share
    integer(i8), intent(in), optional :: first

    call put(file, path, single_kind, c_loc(x), alone, share, first)
  end subroutine put_singles

  subroutine put_single_vectors(file, path, x, share, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(sp), intent(in), target, contiguous :: x(:,:)
    type(share_t), intent(in) :: share
    integer(i8), intent(in), optional :: first

    call put(file, path, single_kind, c_loc(x), [size(x, 1, i8)], share, first)
  end subroutine put_single_vectors

  subroutine put_longs(file, path, x, share, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer(i8), intent(in), target, contiguous :: x(:)
    type(share_t), intent(in) :: share
    integer(i8), intent(in), optional :: first

    call put(file, path, long_kind, c_loc(x), alone, share, first)
  end subroutine put_longs

  subroutine put_long_vectors(file, path, x, share, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer(i8), intent(in), target, contiguous :: x(:,:)
    type(share_t), intent(in) :: share
    integer(i8), intent(in), optional :: first

    call put(file, path, long_kind, c_loc(x), [size(x, 1, i8)], share, first)
  end subroutine put_long_vectors

  subroutine put_integers(file, path, x, share, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer, intent(in), target, contiguous :: x(:)
    type(share_t), intent(in) :: share
    integer(i8), intent(in), optional :: first

    call put(file, path, integer_kind, c_loc(x), alone, share, first)
  end subroutine put_integers

  subroutine put_integer_vectors(file, path, x, share, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer, intent(in), target, contiguous :: x(:,:)
    type(share_t), intent(in) :: share
    integer(i8), intent(in), optional :: first

    call put(file, path, integer_kind, c_loc(x), [size(x, 1, i8)], share, first)
  end subroutine put_integer_vectors

  subroutine put(file, path, kind, x, lead, share, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer, intent(in) :: kind
    type(c_ptr), intent(in) :: x
    integer(i8), intent(in) :: lead(:)  !< the dimensions before that of the columns
    type(share_t), intent(in) :: share
    integer(i8), intent(in), optional :: first

    integer(i8) :: start

    start = 0
    if (present(first)) then
      start = first
      call file%resize(path, start + share%total)
    end if
    if (share%total == 0) return
    call file%write(path, kind, x, [0*lead, start + share%before], [lead, share%mine])
  end subroutine put

  subroutine get_reals(file, path, x, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(wp), intent(inout), target, contiguous :: x(:)
    integer(i8), intent(in) :: first

    call file%read(path, real_kind, c_loc(x), [first], shape(x, i8))
  end subroutine get_reals

  subroutine get_vectors(file, path, x, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(wp), intent(inout), target, contiguous :: x(:,:)
    integer(i8), intent(in) :: first

    call file%read(path, real_kind, c_loc(x), [0_i8, first], shape(x, i8))
  end subroutine get_vectors

  subroutine get_longs(file, path, x, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer(i8), intent(inout), target, contiguous :: x(:)
    integer(i8), intent(in) :: first

    call file%read(path, long_kind, c_loc(x), [first], shape(x, i8))
  end subroutine get_longs

  subroutine get_long_vectors(file, path, x, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer(i8), intent(inout), target, contiguous :: x(:,:)
    integer(i8), intent(in) :: first

    call file%read(path, long_kind, c_loc(x), [0_i8, first], shape(x, i8))
  end subroutine get_long_vectors

  subroutine get_integers(file, path, x, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer, intent(inout), target, contiguous :: x(:)
    integer(i8), intent(in) :: first

    call file%read(path, integer_kind, c_loc(x), [first], shape(x, i8))
  end subroutine get_integers

  subroutine get_integer_vectors(file, path, x, first)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer, intent(inout), target, contiguous :: x(:,:)
    integer(i8), intent(in) :: first

    call file%read(path, integer_kind, c_loc(x), [0_i8, first], shape(x, i8))
  end subroutine get_integer_vectors

  subroutine put_real_block(file, path, f, lower, step)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(wp), intent(in), target, contiguous :: f(:,:,:)
    integer, intent(in) :: lower(3)
    integer(i8), intent(in), optional :: step

    call put_cells(file, path, real_kind, c_loc(f), shape(f, i8), lower, step)
  end subroutine put_real_block

  subroutine put_real_vector_block(file, path, f, lower, step)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(wp), intent(in), target, contiguous :: f(:,:,:,:)
    integer, intent(in) :: lower(3)
    integer(i8), intent(in), optional :: step

    call put_cells(file, path, real_kind, c_loc(f), shape(f, i8), lower, step)
  end subroutine put_real_vector_block

  subroutine put_single_block(file, path, f, lower, step)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(sp), intent(in), target, contiguous :: f(:,:,:)
    integer, intent(in) :: lower(3)
    integer(i8), intent(in), optional :: step

    call put_cells(file, path, single_kind, c_loc(f), shape(f, i8), lower, step)
  end subroutine put_single_block

  subroutine put_single_vector_block(file, path, f, lower, step)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(sp), intent(in), target, contiguous :: f(:,:,:,:)
    integer, intent(in) :: lower(3)
    integer(i8), intent(in), optional :: step

    call put_cells(file, path, single_kind, c_loc(f), shape(f, i8), lower, step)
  end subroutine put_single_vector_block

  subroutine put_cells(file, path, kind, f, extent, lower, step)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    integer, intent(in) :: kind, lower(3)
    type(c_ptr), intent(in) :: f
    integer(i8), intent(in) :: extent(:)  !< 3 or 4 numbers
    integer(i8), intent(in), optional :: step

    integer(i8) :: offset(size(extent))

    offset = 0
    offset(size(extent) - 2:) = lower - 1
    if (present(step)) then
      call file%resize(path, step + 1)
      call file%write(path, kind, f, [offset, step], [extent, 1_i8])
    else
      call file%write(path, kind, f, offset, extent)
    end if
  end subroutine put_cells

  subroutine get_real_block(file, path, f, lower)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path
    real(wp), intent(inout), target, contiguous :: f(:,:,:)
    integer, intent(in) :: lower(3)

    call file%read(path, real_kind, c_loc(f), lower - 1_i8, shape(f, i8))
  end subroutine get_real_block

  subroutine put_text_attribute(file, path, name, text)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path, name
    character(len=*), intent(in) :: text

    character(len=max(len(text), 1)), target :: content   ! HDF5 has no text of length 0

    content = text
    call file%set_attribute(path, name, text_kind, len(content), c_loc(content))
  end subroutine put_text_attribute

  subroutine put_real_attribute(file, path, name, x)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path, name
    real(wp), intent(in), target :: x

    call file%set_attribute(path, name, real_kind, 0, c_loc(x))
  end subroutine put_real_attribute

  subroutine put_reals_attribute(file, path, name, x)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path, name
    real(wp), intent(in), target, contiguous :: x(:)

    call file%set_attribute(path, name, real_kind, size(x), c_loc(x))
  end subroutine put_reals_attribute

  subroutine put_integer_attribute(file, path, name, x)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path, name
    integer, intent(in), target :: x

    call file%set_attribute(path, name, integer_kind, 0, c_loc(x))
  end subroutine put_integer_attribute

  subroutine put_integers_attribute(file, path, name, x)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path, name
    integer, intent(in), target, contiguous :: x(:)

    call file%set_attribute(path, name, integer_kind, size(x), c_loc(x))
  end subroutine put_integers_attribute

  subroutine get_real_attribute(file, path, name, x)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path, name
    real(wp), intent(inout), target :: x

    call file%get_attribute(path, name, real_kind, 0, c_loc(x))
  end subroutine get_real_attribute

  subroutine get_integer_attribute(file, path, name, x)
    type(hdf5_file_t), intent(inout) :: file
    character(len=*), intent(in) :: path, name
    integer, intent(inout), target :: x

    call file%get_attribute(path, name, integer_kind, 0, c_loc(x))
  end subroutine get_integer_attribute

end module hdf5_arrays
