!> What is written comes back bit for bit, on the same ranks column by column, on others in equal runs; the file
!> before is kept. With the arguments FOLDER read, only reads what some number of ranks wrote there before.
program test_restart
  use boxes, only: boxes_t, new_boxes
  use check, only: expect, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use files, only: make_folder, exists
  use hdf5_arrays, only: share_t, share_of
  use hdf5_file, only: start_hdf5, stop_hdf5
  use kinds, only: wp, i8
  use outcome, only: outcome_t, exit_environment
  use provenance, only: provenance_t
  use restart_file, only: restart_writer_t, restart_reader_t
  implicit none

  integer, parameter :: cells(3) = [4, 6, 8], total = 1001
  type(communicator_t) :: comm
  type(outcome_t) :: outcome
  type(boxes_t) :: boxes
  character(len=300) :: folder, task
  logical :: ok(6), there

  call start_ranks(comm)
  call start_hdf5()
  write (folder, '(a,i0)') 'build/tests/restart_', comm%size
  task = 'write and read'
  if (command_argument_count() > 0) call get_command_argument(1, folder)
  if (command_argument_count() > 1) call get_command_argument(2, task)
  if (comm%is_root()) call make_folder(trim(folder), outcome)
  call new_boxes(comm, cells, [.false., .true., .false.], boxes, outcome)
  if (task /= 'read') call write_file(0.25_wp)
  if (task /= 'read') call write_file(0.1_wp)
  call tell(outcome, 'the file is written')
  call read_file(ok)
  call tell(outcome, 'the file is read')
  call show(ok(1), 'vectors come back bit for bit')
  call show(ok(2), 'integers come back')
  call show(ok(3), 'an array without columns comes back')
  call show(ok(4), 'a field comes back bit for bit')
  call show(ok(5), 'copies come back on all ranks')
  call show(ok(6), 'the time comes back bit for bit')
  there = exists(trim(folder)//'/restart.h5.prev')
  call show(there, 'the file before is kept')
  there = exists(trim(folder)//'/restart.h5.tmp')
  call show(.not. there, 'nothing is left over')
  call test_missing()
  if (comm%is_root()) call finish()
  call stop_hdf5()
  call stop_ranks()

contains

  subroutine show(ok, name)
    logical, intent(in) :: ok
    character(len=*), intent(in) :: name

    logical :: bad

    bad = comm%any_of(.not. ok)
    if (comm%is_root()) call expect(.not. bad, name)
  end subroutine show

  subroutine tell(outcome, name)
    type(outcome_t), intent(in) :: outcome
    character(len=*), intent(in) :: name

    call show(.not. outcome%failed(), name)
    if (outcome%failed()) print '(a)', outcome%message
  end subroutine tell

  !> Column g of the whole array, with every bit in use.
  pure function column(g) result(x)
    integer, intent(in) :: g
    real(wp) :: x(3)

    x = [1.0_wp, 2.0_wp, 5.0_wp]/(7*g)   ! no sin: a vectorized one may differ in the last bit
  end function column

  pure function number(cell) result(f)
    integer, intent(in) :: cell(3)
    real(wp) :: f

    f = 1.0_wp/dot_product(cell, [1, 10, 100])
  end function number

  !> Ranks have different numbers of columns: the first fewest, the last what is left.
  subroutine write_file(time)
    real(wp), intent(in) :: time

    type(restart_writer_t) :: writer
    type(share_t) :: share
    real(wp), allocatable :: x(:,:)
    integer(i8), allocatable :: id(:)
    integer :: n, i, none(2, 0)

    n = merge(total - 10*comm%size*(comm%size - 1)/2, 10*(comm%rank + 1), comm%rank == comm%size - 1)
    share = share_of(comm, n)
    allocate (x(3, n), id(n))
    do i = 1, n
      x(:, i) = column(int(share%before) + i)
      id(i) = 10_i8**15 + share%before + i
    end do
    call writer%create(trim(folder)//'/restart.h5', comm, time, provenance_t('t', 'v', 'c', 'case'))
    call writer%add('state', x)
    call writer%add('id', id)
    call writer%add('powder', int(modulo(id, 5_i8)))
    call writer%add('none', none)
    call writer%add_field('pressure', field(), boxes%lo, cells)
    call writer%add_copy('scalars', [0.1_wp, 0.2_wp])
    call writer%add_copy('step', [17])
    call writer%finish(outcome)
  end subroutine write_file

  function field() result(f)
    real(wp) :: f(boxes%n(1), boxes%n(2), boxes%n(3))

    integer :: i, j, k

    do k = 1, boxes%n(3)
      do j = 1, boxes%n(2)
        do i = 1, boxes%n(1)
          f(i, j, k) = number(boxes%lo - 1 + [i, j, k])
        end do
      end do
    end do
  end function field

  subroutine read_file(ok)
    logical, intent(out) :: ok(6)

    type(restart_reader_t) :: reader
    type(share_t) :: share
    real(wp), allocatable :: x(:,:), scalars(:), f(:,:,:)
    integer(i8), allocatable :: id(:)
    integer, allocatable :: powder(:), none(:,:), step(:)
    integer :: i, n

    call reader%open(trim(folder)//'/restart.h5', comm, outcome)
    call reader%get('state', x)
    call reader%get('id', id)
    call reader%get('powder', powder)
    call reader%get('none', none)
    call reader%get_copy('scalars', scalars)
    call reader%get_copy('step', step)
    f = 0*field()
    call reader%get_field('pressure', f, boxes%lo)
    call reader%close(outcome)
    n = size(x, 2)
    share = share_of(comm, n)
    ok(1) = size(x, 1) == 3 .and. share%total == total .and. size(id) == n .and. size(powder) == n
    ok(2) = ok(1)
    do i = 1, merge(n, 0, ok(1))
      ok(1) = ok(1) .and. all(transfer(x(:, i), [1_i8]) == transfer(column(int(share%before) + i), [1_i8]))
      ok(2) = ok(2) .and. id(i) == 10_i8**15 + share%before + i .and. powder(i) == modulo(id(i), 5_i8)
    end do
    if (reader%ranks == comm%size .and. comm%rank < comm%size - 1) ok(1) = ok(1) .and. n == 10*(comm%rank + 1)
    ok(3) = all(shape(none) == [2, 0])
    ok(4) = all(transfer(f, [1_i8]) == transfer(field(), [1_i8]))
    ok(5) = all(transfer(scalars, [1_i8]) == transfer([0.1_wp, 0.2_wp], [1_i8])) .and. all(step == [17])
    ok(6) = abs(reader%time - 0.1_wp) <= 0.0_wp
  end subroutine read_file

  subroutine test_missing()
    type(restart_reader_t) :: reader
    type(outcome_t) :: missing
    integer, allocatable :: nothing(:)

    call reader%open(trim(folder)//'/absent.h5', comm, missing)
    call show(missing%code == exit_environment, 'a missing file is an outcome, not a crash')
    missing = outcome_t()
    call reader%open(trim(folder)//'/restart.h5', comm, missing)
    call reader%get('absent', nothing)
    call reader%close(missing)
    call show(missing%failed(), 'so is a missing array')
  end subroutine test_missing

end program test_restart
