!> The group of ranks that works on one case, and the sums and maxima over it.
module communicator
  use kinds, only: wp, i8
  use mpi_f08, only: MPI_Comm, MPI_COMM_WORLD, MPI_Init, MPI_Finalize, MPI_Abort, MPI_Comm_rank, &
    MPI_Comm_size, MPI_Allreduce, MPI_Bcast, MPI_Barrier, MPI_Exscan, MPI_Allgather, MPI_Alltoall, &
    MPI_IN_PLACE, MPI_DOUBLE_PRECISION, MPI_INTEGER, MPI_INTEGER8, MPI_LOGICAL, MPI_CHARACTER, &
    MPI_SUM, MPI_MAX, MPI_MIN, MPI_LOR
  implicit none
  private
  public :: communicator_t, start_ranks, stop_ranks, abort_ranks

  type :: communicator_t
    type(MPI_Comm) :: handle
    integer :: rank = 0
    integer :: size = 1
  contains
    procedure :: is_root
    procedure, private :: sum_real, sum_reals, sum_integer
    procedure, private :: max_real, max_reals, min_real, max_integer
    generic :: sum => sum_real, sum_reals, sum_integer     !< sum over all ranks
    generic :: max => max_real, max_reals, max_integer     !< maximum over all ranks
    generic :: min => min_real
    procedure :: any_of                                    !< true if true on any rank
    procedure :: before                                    !< sum over the ranks below this one
    procedure, private :: broadcast_reals, broadcast_integers, broadcast_text, broadcast_longs
    generic :: broadcast => broadcast_reals, broadcast_integers, broadcast_text, broadcast_longs
    procedure :: gather_integers                           !< one integer of every rank, on all
    procedure :: swap_counts                               !< how much each rank sends to each
    procedure :: barrier
  end type communicator_t

contains

  !> Join the ranks of this launch.
  subroutine start_ranks(comm)
    type(communicator_t), intent(out) :: comm

    call MPI_Init()
    comm%handle = MPI_COMM_WORLD
    call MPI_Comm_rank(comm%handle, comm%rank)
    call MPI_Comm_size(comm%handle, comm%size)
  end subroutine start_ranks

  subroutine stop_ranks()
    call MPI_Finalize()
  end subroutine stop_ranks

  !> End all ranks at once, for what one rank alone has met.
  subroutine abort_ranks(comm, code)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: code

    call MPI_Abort(comm%handle, code)
  end subroutine abort_ranks

  pure function is_root(self)
    class(communicator_t), intent(in) :: self
    logical :: is_root

    is_root = self%rank == 0
  end function is_root

  function sum_real(self, x) result(total)
    class(communicator_t), intent(in) :: self
    real(wp), intent(in) :: x
    real(wp) :: total

    call MPI_Allreduce(x, total, 1, MPI_DOUBLE_PRECISION, MPI_SUM, self%handle)
  end function sum_real

  function sum_reals(self, x) result(total)
    class(communicator_t), intent(in) :: self
    real(wp), intent(in) :: x(:)
    real(wp) :: total(size(x))

    total = x
    call MPI_Allreduce(MPI_IN_PLACE, total, size(x), MPI_DOUBLE_PRECISION, MPI_SUM, self%handle)
  end function sum_reals

  function sum_integer(self, x) result(total)
    class(communicator_t), intent(in) :: self
    integer(i8), intent(in) :: x
    integer(i8) :: total

    call MPI_Allreduce(x, total, 1, MPI_INTEGER8, MPI_SUM, self%handle)
  end function sum_integer

  function max_real(self, x) result(largest)
    class(communicator_t), intent(in) :: self
    real(wp), intent(in) :: x
    real(wp) :: largest

    call MPI_Allreduce(x, largest, 1, MPI_DOUBLE_PRECISION, MPI_MAX, self%handle)
  end function max_real

  function max_reals(self, x) result(largest)
    class(communicator_t), intent(in) :: self
    real(wp), intent(in) :: x(:)
    real(wp) :: largest(size(x))

    largest = x
    call MPI_Allreduce(MPI_IN_PLACE, largest, size(x), MPI_DOUBLE_PRECISION, MPI_MAX, self%handle)
  end function max_reals

  function min_real(self, x) result(smallest)
    class(communicator_t), intent(in) :: self
    real(wp), intent(in) :: x
    real(wp) :: smallest

    call MPI_Allreduce(x, smallest, 1, MPI_DOUBLE_PRECISION, MPI_MIN, self%handle)
  end function min_real

  function max_integer(self, x) result(largest)
    class(communicator_t), intent(in) :: self
    integer, intent(in) :: x
    integer :: largest

    call MPI_Allreduce(x, largest, 1, MPI_INTEGER, MPI_MAX, self%handle)
  end function max_integer

  function any_of(self, flag)
    class(communicator_t), intent(in) :: self
    logical, intent(in) :: flag
    logical :: any_of

    call MPI_Allreduce(flag, any_of, 1, MPI_LOGICAL, MPI_LOR, self%handle)
  end function any_of

  function before(self, x) result(offset)
    class(communicator_t), intent(in) :: self
    integer(i8), intent(in) :: x
    integer(i8) :: offset

    offset = 0_i8
    call MPI_Exscan(x, offset, 1, MPI_INTEGER8, MPI_SUM, self%handle)
    if (self%rank == 0) offset = 0_i8
  end function before

  subroutine broadcast_reals(self, x)
    class(communicator_t), intent(in) :: self
    real(wp), intent(inout) :: x(:)

    call MPI_Bcast(x, size(x), MPI_DOUBLE_PRECISION, 0, self%handle)
  end subroutine broadcast_reals

  subroutine broadcast_integers(self, x)
    class(communicator_t), intent(in) :: self
    integer, intent(inout) :: x(:)

    call MPI_Bcast(x, size(x), MPI_INTEGER, 0, self%handle)
  end subroutine broadcast_integers

  subroutine broadcast_longs(self, x)
    class(communicator_t), intent(in) :: self
    integer(i8), intent(inout) :: x(:)

    call MPI_Bcast(x, size(x), MPI_INTEGER8, 0, self%handle)
  end subroutine broadcast_longs

  !> Give every rank the root's text, whatever its length.
  subroutine broadcast_text(self, text)
    class(communicator_t), intent(in) :: self
    character(len=:), allocatable, intent(inout) :: text

    integer :: length

    if (self%is_root()) length = len(text)
    call MPI_Bcast(length, 1, MPI_INTEGER, 0, self%handle)
    if (.not. self%is_root()) then
      if (allocated(text)) deallocate (text)
      allocate (character(len=length) :: text)
    end if
    if (length > 0) call MPI_Bcast(text, length, MPI_CHARACTER, 0, self%handle)
  end subroutine broadcast_text

  function gather_integers(self, x) result(all)
    class(communicator_t), intent(in) :: self
    integer, intent(in) :: x
    integer :: all(0:self%size - 1)

    call MPI_Allgather(x, 1, MPI_INTEGER, all, 1, MPI_INTEGER, self%handle)
  end function gather_integers

  !> From how much I send to each rank, how much each sends to me.
  function swap_counts(self, outgoing) result(incoming)
    class(communicator_t), intent(in) :: self
    integer, intent(in) :: outgoing(0:)
    integer :: incoming(0:self%size - 1)

    call MPI_Alltoall(outgoing, 1, MPI_INTEGER, incoming, 1, MPI_INTEGER, self%handle)
  end function swap_counts

  subroutine barrier(self)
    class(communicator_t), intent(in) :: self

    call MPI_Barrier(self%handle)
  end subroutine barrier

end module communicator
