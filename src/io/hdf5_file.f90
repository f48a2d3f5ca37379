!> HDF5 files: the only place of the program that knows the HDF5 library.
!>
!> A file is either shared by the ranks of a communicator, and then every call is made by all of them, or it belongs
!> to the one rank that opens it. Objects are named by their path from the root of the file. The first failure is
!> kept and everything after it does nothing, so it is enough to ask once, when the file is closed.
!> Arrays of the common types and shapes are written and read by module hdf5_arrays.
module hdf5_file
  use, intrinsic :: iso_c_binding, only: c_ptr
  use agreement, only: agree
  use communicator, only: communicator_t
  use files, only: why_not, set_environment
  use hdf5, only: hid_t, hsize_t, size_t, h5open_f, h5close_f, h5eset_auto_f, h5kind_to_type, h5pcreate_f, h5pclose_f, &
    h5pset_fapl_mpio_f, h5pset_libver_bounds_f, h5pset_dxpl_mpio_f, h5pset_chunk_f, h5pset_alloc_time_f, h5pset_deflate_f, &
    h5pset_shuffle_f, h5pset_create_inter_group_f, h5pset_coll_metadata_write_f, h5pset_all_coll_metadata_ops_f, &
    h5fcreate_f, h5fopen_f, h5fclose_f, h5gcreate_f, h5gclose_f, h5dcreate_f, h5dopen_f, h5dclose_f, h5dwrite_f, h5dread_f, &
    h5dset_extent_f, h5dget_space_f, h5screate_simple_f, h5sclose_f, h5sselect_hyperslab_f, &
    h5sselect_none_f, h5sget_simple_extent_ndims_f, h5sget_simple_extent_dims_f, h5oopen_f, h5oclose_f, h5acreate_f, h5aopen_f, &
    h5aopen_by_name_f, h5aexists_f, h5adelete_f, h5awrite_f, h5aread_f, h5aclose_f, h5tcopy_f, &
    h5tset_size_f, h5tset_strpad_f, h5tclose_f, h5lexists_f, h5lcreate_hard_f, H5P_DEFAULT_F, H5P_FILE_ACCESS_F, &
    H5P_DATASET_CREATE_F, H5P_DATASET_XFER_F, H5P_LINK_CREATE_F, H5F_ACC_TRUNC_F, H5F_ACC_RDWR_F, H5F_ACC_RDONLY_F, &
    H5F_LIBVER_V18_F, H5F_LIBVER_LATEST_F, H5FD_MPIO_COLLECTIVE_F, H5D_ALLOC_TIME_EARLY_F, H5S_SELECT_SET_F, H5S_UNLIMITED_F, &
    H5_INTEGER_KIND, H5T_NATIVE_DOUBLE, H5T_NATIVE_REAL, H5T_NATIVE_INTEGER, H5T_FORTRAN_S1, H5T_STR_NULLPAD_F
  use kinds, only: wp, i8
  use mpi_f08, only: MPI_INFO_NULL
  use outcome, only: outcome_t, exit_environment
  implicit none
  private
  public :: hdf5_file_t, start_hdf5, stop_hdf5, real_kind, single_kind, long_kind, integer_kind, text_kind

  !> Types of numbers, the same in memory and in the file: HDF5 1.10 cannot convert while it writes collectively.
  integer, parameter :: real_kind = 1, single_kind = 2, long_kind = 3, integer_kind = 4, text_kind = 5

  integer, parameter :: compression = 4  !< deflate level; higher ones cost time and save little

  type :: hdf5_file_t
    private
    character(len=:), allocatable :: name
    type(communicator_t) :: comm
    logical :: shared = .false.
    integer(hid_t) :: id = -1
    type(outcome_t) :: outcome
  contains
    procedure :: create
    procedure :: open => open_file
    procedure :: close => close_file
    procedure :: failed
    procedure :: has
    procedure :: make_group
    procedure :: give_name
    procedure :: set_attribute
    procedure :: get_attribute
    procedure :: make
    procedure :: write => write_slab
    procedure :: read => read_slab
    procedure :: shape_of
    procedure :: resize
    procedure, private :: check
    procedure, private :: settle
  end type hdf5_file_t

contains

  !> Once, after start_ranks and before any file.
  subroutine start_hdf5()
    integer :: error

    ! Locks make a reader stop the run and fail on some network file systems. A writer holds no file open for long,
    ! so a reader without a lock meets a half-written file hardly ever, and can read again.
    call set_environment('HDF5_USE_FILE_LOCKING', 'FALSE')
    call h5open_f(error)
    if (error < 0) error stop 'hdf5: the library does not start'
    call h5eset_auto_f(0, error)
  end subroutine start_hdf5

  subroutine stop_hdf5()
    integer :: error

    call h5close_f(error)
  end subroutine stop_hdf5

  !> Begin a new file; one of that name is lost.
  subroutine create(self, name, comm)
    class(hdf5_file_t), intent(out) :: self
    character(len=*), intent(in) :: name
    type(communicator_t), intent(in), optional :: comm  !< the ranks that share the file; absent: this one alone

    call reach(self, name, H5F_ACC_TRUNC_F, comm)
  end subroutine create

  !> Open a file that exists.
  subroutine open_file(self, name, to_write, comm)
    class(hdf5_file_t), intent(out) :: self
    character(len=*), intent(in) :: name
    logical, intent(in) :: to_write
    type(communicator_t), intent(in), optional :: comm

    call reach(self, name, merge(H5F_ACC_RDWR_F, H5F_ACC_RDONLY_F, to_write), comm)
  end subroutine open_file

  subroutine reach(self, name, mode, comm)
    type(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: mode
    type(communicator_t), intent(in), optional :: comm

    integer :: error
    integer(hid_t) :: access

    self%name = name
    ! One rank alone needs no MPI to write, and some of its collective writes across chunks fail in Open MPI 4.1.
    if (present(comm)) self%shared = comm%size > 1
    call h5pcreate_f(H5P_FILE_ACCESS_F, access, error)
    ! Not V110 as the lowest: its files carry an "open" mark that a killed run leaves behind, and nobody can read them.
    call h5pset_libver_bounds_f(access, H5F_LIBVER_V18_F, H5F_LIBVER_LATEST_F, error)
    if (self%shared) then
      self%comm = comm
      call h5pset_fapl_mpio_f(access, comm%handle%MPI_VAL, MPI_INFO_NULL%MPI_VAL, error)
      ! One rank reads the structure of the file and tells the others.
      call h5pset_all_coll_metadata_ops_f(access, .true., error)
      call h5pset_coll_metadata_write_f(access, .true., error)
    end if
    if (mode == H5F_ACC_TRUNC_F) call h5fcreate_f(name, mode, self%id, error, H5P_DEFAULT_F, access)
    if (mode /= H5F_ACC_TRUNC_F) call h5fopen_f(name, mode, self%id, error, access)
    call self%check(error, trim(merge('create', 'open  ', mode == H5F_ACC_TRUNC_F))//' the file')
    call self%settle()
    call h5pclose_f(access, error)
  end subroutine reach

  !> Close the file, and tell how all went since it was opened.
  subroutine close_file(self, outcome)
    class(hdf5_file_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    integer :: error

    if (self%id >= 0) then
      call h5fclose_f(self%id, error)
      call self%check(error, 'close the file')
      self%id = -1
    end if
    call self%settle()
    if (self%failed()) call outcome%fail(self%outcome%code, self%outcome%message)
  end subroutine close_file

  pure function failed(self)
    class(hdf5_file_t), intent(in) :: self
    logical :: failed

    failed = self%outcome%failed()
  end function failed

  !> Keep the first failure of a library call.
  subroutine check(self, error, action)
    class(hdf5_file_t), intent(inout) :: self
    integer, intent(in) :: error
    character(len=*), intent(in) :: action  !< what could not be done

    if (error >= 0 .or. self%failed()) return
    call self%outcome%fail(exit_environment, 'cannot '//action//" ('"//self%name//"')"//why_not(self%name))
  end subroutine check

  !> If one rank failed, all did: from here on none of them waits for another.
  subroutine settle(self)
    class(hdf5_file_t), intent(inout) :: self

    if (self%shared) call agree(self%comm, self%outcome)
  end subroutine settle

  !> Whether the file has an object at this path.
  function has(self, path)
    class(hdf5_file_t), intent(in) :: self
    character(len=*), intent(in) :: path
    logical :: has

    integer :: error, i

    has = .false.
    if (self%failed()) return
    do i = 2, len(path)   ! the groups on the way must be asked for one by one
      if (path(i:i) /= '/') cycle
      call h5lexists_f(self%id, path(:i - 1), has, error)
      if (.not. has) return
    end do
    call h5lexists_f(self%id, path, has, error)
  end function has

  subroutine make_group(self, path)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path

    integer :: error
    integer(hid_t) :: group

    if (self%failed()) return
    call h5gcreate_f(self%id, path, group, error)
    call self%check(error, 'make '//path)
    call h5gclose_f(group, error)
  end subroutine make_group

  !> Another name for an object, beside the one it has; the group it lies in may be new.
  subroutine give_name(self, path, name)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    character(len=*), intent(in) :: name  !< the whole path of the other one

    integer :: error
    integer(hid_t) :: links

    if (self%failed()) return
    call h5pcreate_f(H5P_LINK_CREATE_F, links, error)
    call h5pset_create_inter_group_f(links, 1, error)
    call h5lcreate_hard_f(self%id, path, self%id, name, error, links)
    call self%check(error, 'name '//path//' '//name)
    call h5pclose_f(links, error)
  end subroutine give_name

  !> Set an attribute of the object at `path`: `length` values, or one for length 0; a text of `length` characters.
  subroutine set_attribute(self, path, name, kind, length, values)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path, name
    integer, intent(in) :: kind, length
    type(c_ptr), intent(in) :: values

    integer :: error
    integer(hid_t) :: object, space, attribute, type
    logical :: old

    if (self%failed()) return
    type = native(kind, length)
    call h5oopen_f(self%id, path, object, error)
    call self%check(error, 'find '//path)
    call h5aexists_f(object, name, old, error)
    ! A number is written over the old one, so that no moment is without; a text may have a new length.
    if (old .and. kind == text_kind) call h5adelete_f(object, name, error)
    if (old .and. kind /= text_kind) then
      call h5aopen_f(object, name, attribute, error)
    else
      call h5screate_simple_f(merge(1, 0, length > 0 .and. kind /= text_kind), [int(length, hsize_t)], space, error)
      call h5acreate_f(object, name, type, space, attribute, error)
      call h5sclose_f(space, error)
    end if
    call h5awrite_f(attribute, type, values, error)
    call self%check(error, 'write '//path//':'//name)
    call h5aclose_f(attribute, error)
    call h5oclose_f(object, error)
    if (kind == text_kind) call h5tclose_f(type, error)
  end subroutine set_attribute

  !> Read an attribute whose kind and length are known (0: one value); its absence is a failure.
  subroutine get_attribute(self, path, name, kind, length, values)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path, name
    integer, intent(in) :: kind, length
    type(c_ptr), intent(in) :: values

    integer :: error
    integer(hid_t) :: attribute, type
    type(c_ptr) :: address

    if (self%failed()) return
    address = values
    type = native(kind, length)
    call h5aopen_by_name_f(self%id, path, name, attribute, error)
    call h5aread_f(attribute, type, address, error)
    call self%check(error, 'read '//path//':'//name)
    call h5aclose_f(attribute, error)
    if (kind == text_kind) call h5tclose_f(type, error)
  end subroutine get_attribute

  !> A new dataset; groups on its path are made. Where a chunk is given, it can grow along its last dimension.
  subroutine make(self, path, kind, extent, chunk, compressed)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer, intent(in) :: kind                            !< real_kind, ...
    integer(i8), intent(in) :: extent(:)                   !< size in each dimension, as in Fortran
    integer(i8), intent(in), optional :: chunk(:)          !< the piece in which it is stored
    logical, intent(in), optional :: compressed

    integer :: error
    integer(hid_t) :: space, layout, links, dataset
    integer(hsize_t) :: largest(size(extent))

    if (self%failed()) return
    largest = extent
    if (present(chunk)) largest(size(extent)) = H5S_UNLIMITED_F
    call h5screate_simple_f(size(extent), int(extent, hsize_t), space, error, largest)
    call h5pcreate_f(H5P_LINK_CREATE_F, links, error)
    call h5pset_create_inter_group_f(links, 1, error)
    call h5pcreate_f(H5P_DATASET_CREATE_F, layout, error)
    if (present(chunk)) call h5pset_chunk_f(layout, size(chunk), int(chunk, hsize_t), error)
    ! Space that is allocated late breaks collective writes, if the dataset was made by one rank alone.
    if (present(chunk) .and. .not. present(compressed)) call h5pset_alloc_time_f(layout, H5D_ALLOC_TIME_EARLY_F, error)
    if (present(compressed)) then
      if (compressed) call h5pset_shuffle_f(layout, error)
      if (compressed) call h5pset_deflate_f(layout, compression, error)
    end if
    call h5dcreate_f(self%id, path, native(kind), space, dataset, error, layout, links)
    call self%check(error, 'make '//path)
    call h5dclose_f(dataset, error)
    call h5pclose_f(layout, error)
    call h5pclose_f(links, error)
    call h5sclose_f(space, error)
  end subroutine make

  !> Write my block of a dataset. A rank with nothing to write (a count of 0) takes part all the same.
  subroutine write_slab(self, path, kind, values, offset, count)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer, intent(in) :: kind
    type(c_ptr), intent(in) :: values                  !< contiguous, of that kind
    integer(i8), intent(in) :: offset(:), count(:)     !< in each dimension, from 0

    call move_slab(self, path, kind, values, offset, count, .true.)
  end subroutine write_slab

  !> Read my block of a dataset.
  subroutine read_slab(self, path, kind, values, offset, count)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer, intent(in) :: kind
    type(c_ptr), intent(in) :: values
    integer(i8), intent(in) :: offset(:), count(:)

    call move_slab(self, path, kind, values, offset, count, .false.)
  end subroutine read_slab

  subroutine move_slab(self, path, kind, values, offset, count, to_file)
    type(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer, intent(in) :: kind
    type(c_ptr), intent(in) :: values
    integer(i8), intent(in) :: offset(:), count(:)
    logical, intent(in) :: to_file

    integer :: error, rank
    integer(hid_t) :: dataset, file_space, space, mode
    integer(hsize_t) :: sizes(7)
    type(c_ptr) :: address

    call look_at(self, path, dataset, rank, sizes)
    if (self%failed()) return
    address = values
    call h5dget_space_f(dataset, file_space, error)
    call h5screate_simple_f(size(count), int(max(count, 1_i8), hsize_t), space, error)
    call h5sselect_hyperslab_f(file_space, H5S_SELECT_SET_F, int(offset, hsize_t), int(count, hsize_t), error)
    if (product(count) == 0) call h5sselect_none_f(file_space, error)
    if (product(count) == 0) call h5sselect_none_f(space, error)
    call h5pcreate_f(H5P_DATASET_XFER_F, mode, error)
    if (self%shared) call h5pset_dxpl_mpio_f(mode, H5FD_MPIO_COLLECTIVE_F, error)
    if (to_file) call h5dwrite_f(dataset, native(kind), address, error, space, file_space, mode)
    if (.not. to_file .and. product(sizes(:rank)) > 0) then   ! the library cannot read from an empty dataset
      call h5dread_f(dataset, native(kind), address, error, space, file_space, mode)
    end if
    call self%check(error, trim(merge('write', 'read ', to_file))//' '//path)
    call h5pclose_f(mode, error)
    call h5sclose_f(space, error)
    call h5sclose_f(file_space, error)
    call h5dclose_f(dataset, error)
    call self%settle()
  end subroutine move_slab

  !> The size of a dataset in each dimension, as in Fortran.
  function shape_of(self, path) result(extent)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(i8), allocatable :: extent(:)

    integer :: error, rank
    integer(hid_t) :: dataset
    integer(hsize_t) :: sizes(7)

    call look_at(self, path, dataset, rank, sizes)
    allocate (extent(rank), source=int(sizes(:rank), i8))
    if (.not. self%failed()) call h5dclose_f(dataset, error)
  end function shape_of

  !> Grow or shrink a dataset along its last dimension.
  subroutine resize(self, path, length)
    class(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(i8), intent(in) :: length

    integer :: error, rank
    integer(hid_t) :: dataset
    integer(hsize_t) :: sizes(7)

    call look_at(self, path, dataset, rank, sizes)
    if (self%failed()) return
    sizes(rank) = length
    call h5dset_extent_f(dataset, sizes(:rank), error)
    call self%check(error, 'resize '//path)
    call h5dclose_f(dataset, error)
  end subroutine resize

  !> Open a dataset and tell its size.
  subroutine look_at(self, path, dataset, rank, sizes)
    type(hdf5_file_t), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer(hid_t), intent(out) :: dataset
    integer, intent(out) :: rank
    integer(hsize_t), intent(out) :: sizes(:)

    integer :: error
    integer(hid_t) :: space
    integer(hsize_t) :: largest(size(sizes))

    rank = 1
    sizes = 0
    if (self%failed()) return
    call h5dopen_f(self%id, path, dataset, error)
    call self%check(error, 'find '//path)
    if (self%failed()) return
    call h5dget_space_f(dataset, space, error)
    call h5sget_simple_extent_ndims_f(space, rank, error)
    call h5sget_simple_extent_dims_f(space, sizes, largest, error)
    call h5sclose_f(space, error)
  end subroutine look_at

  !> The library's name of a type of numbers, or of a text of `length` characters (to be closed after use).
  function native(kind, length) result(type)
    integer, intent(in) :: kind
    integer, intent(in), optional :: length
    integer(hid_t) :: type

    integer :: error

    select case (kind)
    case (real_kind)
      type = H5T_NATIVE_DOUBLE
    case (single_kind)
      type = H5T_NATIVE_REAL
    case (long_kind)
      type = h5kind_to_type(i8, H5_INTEGER_KIND)
    case (integer_kind)
      type = H5T_NATIVE_INTEGER
    case (text_kind)
      call h5tcopy_f(H5T_FORTRAN_S1, type, error)
      call h5tset_size_f(type, int(max(length, 1), size_t), error)
      call h5tset_strpad_f(type, H5T_STR_NULLPAD_F, error)   ! what VTK expects
    case default
      error stop 'hdf5_file: no such kind'
    end select
  end function native

end module hdf5_file
