!> Items that go from any rank to any rank, by messages between those that have something to say.
!>
!> A route is set once for a list of destinations and then used many times: parcels move house with one, and
!> their ghosts are kept up to date with another, every solids step. Sending allocates nothing once a row of
!> that length has been sent.
!>
!> Items arrive ordered by the rank they come from, and from one rank in the order they had there.
module route
  use communicator, only: communicator_t
  use kinds, only: wp, i8
  use mpi_f08, only: MPI_Request, MPI_Irecv, MPI_Isend, MPI_Waitall, MPI_F_sync_reg, &
    MPI_DOUBLE_PRECISION, MPI_STATUSES_IGNORE
  implicit none
  private
  public :: route_t

  integer, parameter :: tag = 11

  !> The part of a buffer that goes to, or comes from, one other rank.
  type :: leg_t
    integer :: rank
    integer :: first  !< position of its first item, from 1
    integer :: items
  end type leg_t

  type :: route_t
    integer :: n_sent = 0      !< items I send, to myself included
    integer :: n_received = 0  !< items I receive
    type(communicator_t), private :: comm
    type(leg_t), allocatable, private :: outward(:), inward(:)  !< messages to and from the other ranks
    type(leg_t), private :: own_outward, own_inward             !< what stays with me
    integer, allocatable, private :: order(:)                   !< (n_sent) item at each position of the outgoing buffer
    integer, allocatable, private :: column(:)                  !< (n_sent) its column of the sender's array
    integer, allocatable, private :: shifted(:)                 !< positions of the periodic images
    real(wp), allocatable, private :: shift(:,:)                !< (3, images) what is added to their position [m]
    real(wp), allocatable, private :: outgoing(:), incoming(:)  !< rows one after the other
    type(MPI_Request), allocatable, private :: request(:)
  contains
    procedure :: set
    procedure, private :: send_reals, send_longs
    generic :: send => send_reals, send_longs
    procedure :: refresh
  end type route_t

contains

  !> Lay the route: item i goes to the rank destination(i). All ranks take part, with lists of any length.
  !> For `refresh`: column(i) is where the sender keeps item i, shift(:,i) what is added to its position.
  subroutine set(self, comm, destination, column, shift)
    class(route_t), intent(inout) :: self
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: destination(:)           !< (n)
    integer, intent(in), optional :: column(:)      !< (n)
    real(wp), intent(in), optional :: shift(:,:)    !< (3,n) [m]

    integer :: i, k, outgoing(0:comm%size - 1), next(0:comm%size - 1)

    self%comm = comm
    self%n_sent = size(destination)
    outgoing = 0
    do i = 1, self%n_sent
      outgoing(destination(i)) = outgoing(destination(i)) + 1
    end do
    call list_legs(comm%rank, outgoing, self%outward, self%own_outward)
    call list_legs(comm%rank, comm%swap_counts(outgoing), self%inward, self%own_inward)
    self%n_received = self%own_inward%items + sum(self%inward%items)
    if (allocated(self%request)) deallocate (self%request)
    allocate (self%request(size(self%outward) + size(self%inward)))

    next = [(1 + sum(outgoing(:i - 1)), i=0, comm%size - 1)]
    call resize(self%order, self%n_sent)
    do i = 1, self%n_sent
      k = next(destination(i))
      next(destination(i)) = k + 1
      self%order(k) = i
    end do
    if (allocated(self%column)) deallocate (self%column)
    if (present(column)) self%column = column(self%order)
    call list_images(self, shift)
  end subroutine set

  !> The messages among counts(rank), one for each other rank that has items, and my own part.
  pure subroutine list_legs(me, counts, legs, own)
    integer, intent(in) :: me, counts(0:)
    type(leg_t), allocatable, intent(out) :: legs(:)
    type(leg_t), intent(out) :: own

    integer :: rank, first, m

    allocate (legs(count(counts > 0) - merge(1, 0, counts(me) > 0)))
    first = 1
    m = 0
    do rank = 0, size(counts) - 1
      if (rank == me) then
        own = leg_t(rank, first, counts(rank))
      else if (counts(rank) > 0) then
        m = m + 1
        legs(m) = leg_t(rank, first, counts(rank))
      end if
      first = first + counts(rank)
    end do
  end subroutine list_legs

  !> Note which positions carry a periodic shift; most do not.
  pure subroutine list_images(self, shift)
    class(route_t), intent(inout) :: self
    real(wp), intent(in), optional :: shift(:,:)

    integer :: k

    self%shifted = [integer ::]
    if (present(shift)) then
      self%shifted = pack([(k, k=1, self%n_sent)], [(any(abs(shift(:, self%order(k))) > 0), k=1, self%n_sent)])
      self%shift = shift(:, self%order(self%shifted))
    end if
  end subroutine list_images

  pure subroutine resize(list, n)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(in) :: n

    if (allocated(list)) then
      if (size(list) == n) return
      deallocate (list)
    end if
    allocate (list(n))
  end subroutine resize

  !> Send rows_in(:,i) of every item along the route.
  subroutine send_reals(self, rows_in, rows_out)
    class(route_t), intent(inout) :: self
    real(wp), intent(in) :: rows_in(:,:)       !< (rows, n_sent) in the order of the destinations
    real(wp), intent(inout) :: rows_out(:,:)   !< (rows, n_received)

    integer :: rows, k

    rows = size(rows_in, 1)
    call reserve(self, rows)
    do k = 1, self%n_sent
      self%outgoing(rows*(k - 1) + 1:rows*k) = rows_in(:, self%order(k))
    end do
    call swap(self, rows)
    do k = 1, self%n_received
      rows_out(:, k) = self%incoming(rows*(k - 1) + 1:rows*k)
    end do
  end subroutine send_reals

  !> The same for integers of the length of a real, whose bits travel as they are.
  subroutine send_longs(self, rows_in, rows_out)
    class(route_t), intent(inout) :: self
    integer(i8), intent(in) :: rows_in(:,:)      !< (rows, n_sent)
    integer(i8), intent(inout) :: rows_out(:,:)  !< (rows, n_received)

    integer :: rows, k, i

    rows = size(rows_in, 1)
    call reserve(self, rows)
    do k = 1, self%n_sent
      do i = 1, rows
        self%outgoing(rows*(k - 1) + i) = transfer(rows_in(i, self%order(k)), 0.0_wp)
      end do
    end do
    call swap(self, rows)
    do k = 1, self%n_received
      do i = 1, rows
        rows_out(i, k) = transfer(self%incoming(rows*(k - 1) + i), 0_i8)
      end do
    end do
  end subroutine send_longs

  !> Bring ghosts up to date: the first `rows` rows of the columns the route was set for, periodic shift added
  !> to the position in rows 1 to 3, into the columns first, first + 1, ... of the receivers' arrays.
  subroutine refresh(self, state, rows, first)
    class(route_t), intent(inout) :: self
    real(wp), intent(inout), contiguous :: state(:,:)  !< (at least rows, columns)
    integer, intent(in) :: rows
    integer, intent(in) :: first                       !< column of the first ghost

    integer :: k, i, at

    call reserve(self, rows)
    do k = 1, self%n_sent
      at = rows*(k - 1)
      do i = 1, rows
        self%outgoing(at + i) = state(i, self%column(k))
      end do
    end do
    do k = 1, size(self%shifted)
      at = rows*(self%shifted(k) - 1)
      self%outgoing(at + 1:at + 3) = self%outgoing(at + 1:at + 3) + self%shift(:, k)
    end do
    call swap(self, rows)
    do k = 1, self%n_received
      at = rows*(k - 1)
      do i = 1, rows
        state(i, first + k - 1) = self%incoming(at + i)
      end do
    end do
  end subroutine refresh

  !> Let the buffers hold rows of this length, with room to spare so that they seldom grow.
  subroutine reserve(self, rows)
    class(route_t), intent(inout) :: self
    integer, intent(in) :: rows

    call grow(self%outgoing, rows*self%n_sent)
    call grow(self%incoming, rows*self%n_received)
  end subroutine reserve

  pure subroutine grow(buffer, length)
    real(wp), allocatable, intent(inout) :: buffer(:)
    integer, intent(in) :: length

    if (allocated(buffer)) then
      if (size(buffer) >= length) return
      deallocate (buffer)
    end if
    allocate (buffer(length + length/4))
  end subroutine grow

  !> The messages themselves, from the outgoing to the incoming buffer.
  subroutine swap(self, rows)
    class(route_t), intent(inout) :: self
    integer, intent(in) :: rows

    integer :: m, from, to, length

    do m = 1, size(self%inward)
      associate (leg => self%inward(m))
        call MPI_Irecv(self%incoming(rows*(leg%first - 1) + 1), rows*leg%items, MPI_DOUBLE_PRECISION, &
                       leg%rank, tag, self%comm%handle, self%request(m))
      end associate
    end do
    do m = 1, size(self%outward)
      associate (leg => self%outward(m))
        call MPI_Isend(self%outgoing(rows*(leg%first - 1) + 1), rows*leg%items, MPI_DOUBLE_PRECISION, &
                       leg%rank, tag, self%comm%handle, self%request(size(self%inward) + m))
      end associate
    end do
    from = rows*(self%own_outward%first - 1)
    to = rows*(self%own_inward%first - 1)
    length = rows*self%own_outward%items
    self%incoming(to + 1:to + length) = self%outgoing(from + 1:from + length)
    call MPI_Waitall(size(self%request), self%request, MPI_STATUSES_IGNORE)
    call MPI_F_sync_reg(self%incoming)
    call MPI_F_sync_reg(self%outgoing)
  end subroutine swap

end module route
