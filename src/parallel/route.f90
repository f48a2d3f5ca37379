!> Items that go from any rank to any rank, by messages between those that have something to say.
!>
!> A route is set once for a list of destinations and then used many times: parcels move house with one, and
!> their ghosts are kept up to date with another, every solids step, all of them or those the receivers watch. Sending allocates
!> nothing once a row of that length has been sent.
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

  !> Items that travel together, in the order of the buffers.
  type :: load_t
    type(leg_t), allocatable :: outward(:), inward(:)  !< messages to and from the other ranks
    type(leg_t) :: own_outward, own_inward             !< what stays with me
    integer, allocatable :: column(:)                  !< of each item I send, in my array
    integer, allocatable :: place(:)                   !< of each item I receive, among all that I may receive
    integer, allocatable :: shifted(:)                 !< periodic images among those I send
    real(wp), allocatable :: shift(:,:)                !< (3, images) what is added to their position [m]
  end type load_t

  type :: route_t
    integer :: n_sent = 0      !< items I send, to myself included
    integer :: n_received = 0  !< items I receive
    type(communicator_t), private :: comm
    type(load_t), private :: all, watched
    integer, allocatable, private :: order(:)                   !< (n_sent) item at each position of the outgoing buffer
    real(wp), allocatable, private :: outgoing(:), incoming(:)  !< rows one after the other
    type(MPI_Request), allocatable, private :: request(:)
  contains
    procedure :: set
    procedure, private :: send_reals, send_longs
    generic :: send => send_reals, send_longs
    procedure :: watch
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
    call list_legs(comm%rank, outgoing, self%all%outward, self%all%own_outward)
    call list_legs(comm%rank, comm%swap_counts(outgoing), self%all%inward, self%all%own_inward)
    self%n_received = self%all%own_inward%items + sum(self%all%inward%items)
    if (allocated(self%request)) deallocate (self%request)
    allocate (self%request(size(self%all%outward) + size(self%all%inward)))

    next = [(1 + sum(outgoing(:i - 1)), i=0, comm%size - 1)]
    call resize(self%order, self%n_sent)
    do i = 1, self%n_sent
      k = next(destination(i))
      next(destination(i)) = k + 1
      self%order(k) = i
    end do
    if (.not. (present(column) .and. present(shift))) return
    self%all%column = column(self%order)
    self%all%place = [(k, k=1, self%n_received)]
    self%all%shifted = pack([(k, k=1, self%n_sent)], [(any(abs(shift(:, self%order(k))) > 0), k=1, self%n_sent)])
    self%all%shift = shift(:, self%order(self%all%shifted))
  end subroutine set

  !> Which of the items I receive `refresh` shall bring when asked for the watched ones. All ranks take part.
  subroutine watch(self, wanted)
    class(route_t), intent(inout) :: self
    logical, intent(in) :: wanted(:)  !< (n_received)

    logical :: asked(self%n_sent)

    call reserve(self, 1)
    self%incoming(1:self%n_received) = merge(1.0_wp, 0.0_wp, wanted)
    associate (all => self%all)  ! the wishes go the way back
      call swap(self%comm, 1, all%inward, all%own_inward, self%incoming, all%outward, all%own_outward, self%outgoing, self%request)
    end associate
    asked = self%outgoing(1:self%n_sent) > 0.5_wp
    self%watched = part_of(self%all, asked, wanted)
  end subroutine watch

  !> Some of a load.
  pure function part_of(whole, sent, received) result(part)
    type(load_t), intent(in) :: whole
    logical, intent(in) :: sent(:), received(:)  !< which of the items I send, and receive
    type(load_t) :: part

    logical :: kept(size(whole%shifted))
    integer :: k, kept_so_far(0:size(sent))

    call thin_out(whole%outward, whole%own_outward, sent, part%outward, part%own_outward)
    call thin_out(whole%inward, whole%own_inward, received, part%inward, part%own_inward)
    part%column = pack(whole%column, sent)
    part%place = pack(whole%place, received)
    kept_so_far = running_count(sent)
    kept = sent(whole%shifted)
    part%shifted = kept_so_far(pack(whole%shifted, kept))
    part%shift = whole%shift(:, pack([(k, k=1, size(kept))], kept))
  end function part_of

  !> Messages with only those items that are wanted, and no empty ones.
  pure subroutine thin_out(legs, own, wanted, thin, thin_own)
    type(leg_t), intent(in) :: legs(:), own
    logical, intent(in) :: wanted(:)  !< (items of all)
    type(leg_t), allocatable, intent(out) :: thin(:)
    type(leg_t), intent(out) :: thin_own

    integer :: so_far(0:size(wanted))

    so_far = running_count(wanted)
    thin = thinned(legs, so_far(legs%first - 1), so_far(legs%first + legs%items - 1))
    thin = pack(thin, thin%items > 0)
    thin_own = thinned(own, so_far(own%first - 1), so_far(own%first + own%items - 1))
  end subroutine thin_out

  elemental function thinned(leg, before, up_to)
    type(leg_t), intent(in) :: leg
    integer, intent(in) :: before, up_to  !< wanted items before it, and up to its end
    type(leg_t) :: thinned

    thinned = leg_t(leg%rank, before + 1, up_to - before)
  end function thinned

  !> Element k: how many of the first k are true.
  pure function running_count(mask) result(so_far)
    logical, intent(in) :: mask(:)
    integer :: so_far(0:size(mask))

    integer :: k

    so_far(0) = 0
    do k = 1, size(mask)
      so_far(k) = so_far(k - 1) + merge(1, 0, mask(k))
    end do
  end function running_count

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
    call swap_all(self, rows)
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
    call swap_all(self, rows)
    do k = 1, self%n_received
      do i = 1, rows
        rows_out(i, k) = transfer(self%incoming(rows*(k - 1) + i), 0_i8)
      end do
    end do
  end subroutine send_longs

  !> Bring ghosts up to date: the columns the route was set for, periodic shift added to the position in rows 1 to 3, into the
  !> columns first, first + 1, ... of the receivers' arrays; of every four rows all or the first three, of all ghosts or of those
  !> watched.
  subroutine refresh(self, state, first, of_four, watched)
    class(route_t), intent(inout) :: self
    real(wp), intent(inout), contiguous :: state(:,:)  !< (4, 8 or 12 rows, columns)
    integer, intent(in) :: first                       !< column of the first ghost
    integer, intent(in) :: of_four                     !< how many of every four rows: 3 or 4
    logical, intent(in) :: watched                     !< only the ghosts asked for by `watch`

    integer :: rows

    rows = size(state, 1)/4*of_four
    call reserve(self, rows)
    if (watched) then
      call carry(self%watched)
    else
      call carry(self%all)
    end if

  contains

    subroutine carry(load)
      type(load_t), intent(in) :: load

      integer :: k, at

      call take_rows(of_four, size(state, 1)/4, size(state, 2), state, load%column, self%outgoing)
      do k = 1, size(load%shifted)
        at = rows*(load%shifted(k) - 1)
        self%outgoing(at + 1:at + 3) = self%outgoing(at + 1:at + 3) + load%shift(:, k)
      end do
      call swap(self%comm, rows, load%outward, load%own_outward, self%outgoing, load%inward, load%own_inward, self%incoming, &
                self%request)
      call put_rows(of_four, size(state, 1)/4, size(state, 2), self%incoming, load%place, first, state)
    end subroutine carry

  end subroutine refresh

  !> Element by element: runs of three are not worth the call that gfortran makes of them.
  pure subroutine take_rows(of_four, fours, columns, state, column, buffer)
    integer, intent(in) :: of_four, fours, columns
    real(wp), intent(in) :: state(4, fours, columns)
    integer, intent(in) :: column(:)
    real(wp), intent(inout) :: buffer(of_four, fours, size(column))

    integer :: k, g

    do k = 1, size(column)
      do g = 1, fours
        buffer(1, g, k) = state(1, g, column(k))
        buffer(2, g, k) = state(2, g, column(k))
        buffer(3, g, k) = state(3, g, column(k))
        if (of_four == 4) buffer(4, g, k) = state(4, g, column(k))
      end do
    end do
  end subroutine take_rows

  pure subroutine put_rows(of_four, fours, columns, buffer, place, first, state)
    integer, intent(in) :: of_four, fours, columns, place(:), first
    real(wp), intent(in) :: buffer(of_four, fours, size(place))
    real(wp), intent(inout) :: state(4, fours, columns)

    integer :: k, g, column

    do k = 1, size(place)
      column = first + place(k) - 1
      do g = 1, fours
        state(1, g, column) = buffer(1, g, k)
        state(2, g, column) = buffer(2, g, k)
        state(3, g, column) = buffer(3, g, k)
        if (of_four == 4) state(4, g, column) = buffer(4, g, k)
      end do
    end do
  end subroutine put_rows

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

  !> All items, from the outgoing to the incoming buffer.
  subroutine swap_all(self, rows)
    class(route_t), intent(inout) :: self
    integer, intent(in) :: rows

    associate (all => self%all)
      call swap(self%comm, rows, all%outward, all%own_outward, self%outgoing, all%inward, all%own_inward, self%incoming, &
                self%request)
    end associate
  end subroutine swap_all

  !> The messages themselves, from the outgoing to the incoming buffer.
  subroutine swap(comm, rows, outward, own_outward, outgoing, inward, own_inward, incoming, request)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: rows
    type(leg_t), intent(in) :: outward(:), own_outward, inward(:), own_inward
    real(wp), intent(inout) :: outgoing(:), incoming(:)
    type(MPI_Request), intent(inout) :: request(:)  !< (messages at least)

    integer :: m, from, to, length

    do m = 1, size(inward)
      call MPI_Irecv(incoming(rows*(inward(m)%first - 1) + 1), rows*inward(m)%items, MPI_DOUBLE_PRECISION, inward(m)%rank, tag, &
                     comm%handle, request(m))
    end do
    do m = 1, size(outward)
      call MPI_Isend(outgoing(rows*(outward(m)%first - 1) + 1), rows*outward(m)%items, MPI_DOUBLE_PRECISION, outward(m)%rank, tag, &
                     comm%handle, request(size(inward) + m))
    end do
    from = rows*(own_outward%first - 1)
    to = rows*(own_inward%first - 1)
    length = rows*own_outward%items
    incoming(to + 1:to + length) = outgoing(from + 1:from + length)
    call MPI_Waitall(size(inward) + size(outward), request, MPI_STATUSES_IGNORE)
    call MPI_F_sync_reg(incoming)
    call MPI_F_sync_reg(outgoing)
  end subroutine swap

end module route
