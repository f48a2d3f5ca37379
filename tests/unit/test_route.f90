!> Items sent to random ranks arrive once, in order, and find their way back.
program test_route
  use check, only: expect_all, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use kinds, only: wp, i8
  use route, only: route_t
  implicit none

  type(communicator_t) :: comm
  integer :: round

  call start_ranks(comm)
  do round = 1, 3
    call there_and_back(1000*round)
  end do
  call there_and_back(0)
  call ghosts()
  call watched()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> n items on the root, fewer elsewhere, each with its birthplace and number, sent out and home again.
  subroutine there_and_back(n)
    integer, intent(in) :: n

    type(route_t) :: out, home
    integer :: i, mine, rank
    integer, allocatable :: destination(:)
    real(wp), allocatable :: rows(:,:), received(:,:), back(:,:)
    integer(i8), allocatable :: longs(:,:), long_received(:,:)
    real(wp) :: sums(3)
    logical :: right

    mine = n/(1 + comm%rank)
    allocate (rows(3, mine), longs(1, mine), destination(mine), back(3, mine))
    do i = 1, mine
      destination(i) = modulo(i*i + 7*comm%rank + i/3, comm%size)
      rows(:, i) = [real(comm%rank, wp), real(i, wp), sin(1.0_wp*i)]
      longs(1, i) = ishft(int(i, i8), 34) - comm%rank
    end do
    call out%set(comm, destination)
    allocate (received(3, out%n_received), long_received(1, out%n_received))
    call out%send(rows, received)
    call out%send(longs, long_received)

    right = comm%sum(int(out%n_received, i8)) == comm%sum(int(mine, i8)) .and. out%n_sent == mine
    do i = 2, out%n_received
      right = right .and. (received(1, i) > received(1, i - 1) .or. &
                           (.not. received(1, i) < received(1, i - 1) .and. received(2, i) > received(2, i - 1)))
    end do
    call expect_all(right, 'items arrive by rank, then in the order they had')
    rank = comm%rank
    right = all(modulo(nint(received(2, :))**2 + 7*nint(received(1, :)) + nint(received(2, :))/3, comm%size) == rank)
    call expect_all(right, 'each where it was sent')
    right = all(long_received(1, :) == ishft(int(received(2, :), i8), 34) - nint(received(1, :)))
    call expect_all(right, 'long integers keep all their bits')
    sums = [sum(received(3, :)) - sum(rows(3, :)), sum(received(3, :)**2), sum(rows(3, :)**2)]
    sums = comm%sum(sums)
    call expect_all(abs(sums(1)) < 1e-9_wp .and. abs(sums(2) - sums(3)) < 1e-9_wp, 'sums are kept')

    call home%set(comm, nint(received(1, :)))
    call home%send(received, back)
    right = home%n_received == mine
    do i = 1, mine
      right = right .and. all(abs(rows(:, nint(back(2, i))) - back(:, i)) <= 0)
    end do
    call expect_all(right .and. nint(sum(back(2, :))) == mine*(mine + 1)/2, 'and all come home')
  end subroutine there_and_back

  !> Every rank holds columns 1..5; each is a ghost on the next rank, column 2 of it shifted and also on my own.
  subroutine ghosts()
    integer, parameter :: n = 5
    type(route_t) :: route
    real(wp) :: state(4, 20), shift(3, n + 1)
    integer :: i, step, previous
    logical :: right

    shift = 0
    shift(:, 2) = [10, 20, 30]
    shift(:, n + 1) = [-1, 0, 0]
    call route%set(comm, [spread(modulo(comm%rank + 1, comm%size), 1, n), comm%rank], [5, 4, 3, 2, 1, 2], shift)
    right = route%n_received == n + 1
    do step = 1, 3
      state = -1
      do i = 1, n
        state(:, i) = 100*comm%rank + i + 0.125_wp*step
      end do
      call route%refresh(state, n + 1, 3, watched=.false.)
      previous = modulo(comm%rank - 1, comm%size)
      ! my own image comes before what a higher rank sent, and after what a lower one, or I myself, sent
      associate (mine => merge(n + 1, 2*n + 1, previous > comm%rank), theirs => merge(n + 1, n, previous > comm%rank))
        right = right .and. all(abs(state(1:3, mine) - (100*comm%rank + 2 + 0.125_wp*step + shift(:, n + 1))) <= 0)
        do i = 1, n
          right = right .and. &
                  all(abs(state(1:3, theirs + i) - (100*previous + 6 - i + 0.125_wp*step + shift(:, i))) <= 0)
        end do
      end associate
      right = right .and. all(state(4, n + 1:) < 0) .and. all(state(:, 2*n + 2:) < 0)
    end do
    call expect_all(right, 'ghosts follow, shifted, into their columns and no other')
  end subroutine ghosts

  !> Every rank sends each of the others, and itself, its columns 1 to 6, two of them shifted. Each watches some of what it gets, of
  !> one rank nothing at all, and then others.
  subroutine watched()
    integer, parameter :: n = 6
    type(route_t) :: route
    real(wp) :: state(8, n*(comm%size + 1)), shift(3, n*comm%size), x(8)
    logical :: wanted(n*comm%size), right
    integer :: i, k, rank, step, rows

    shift = 0
    shift(1, 2::n) = 10
    shift(3, 5::n) = -30
    call route%set(comm, [((rank, i=1, n), rank=0, comm%size - 1)], [((i, i=1, n), rank=0, comm%size - 1)], shift)
    right = .true.
    do step = 1, 6
      wanted = [(modulo(k + k/2 + step + comm%rank, 3) == 0, k=1, size(wanted))]
      rank = modulo(comm%rank + step, comm%size)
      if (step < 6) wanted(n*rank + 1:n*(rank + 1)) = .false.
      if (step == 5) wanted = .false.
      state = -1
      do i = 1, n
        state(:, i) = [(100*comm%rank + i + 0.125_wp*step + 0.01_wp*k, k=1, 8)]
      end do
      call route%watch(wanted)
      rows = merge(4, 3, step > 3)
      call route%refresh(state, n + 1, rows, watched=.true.)
      do k = 1, size(wanted)
        rank = (k - 1)/n
        i = k - n*rank
        x = 100*rank + i + 0.125_wp*step + 0.01_wp*[1, 2, 3, 4, 5, 6, 7, 8]
        x(1:3) = x(1:3) + shift(:, i)
        if (.not. wanted(k)) x = -1
        if (rows == 3) x(4:8:4) = -1
        right = right .and. all(abs(state(:, n + k) - x) < 1.0e-12_wp)
      end do
    end do
    call expect_all(right, 'of ghosts those that are watched follow, in all rows or all but every fourth')
  end subroutine watched

end program test_route
