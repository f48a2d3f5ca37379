!> What every unit test program is made of: named expectations, one line each on the screen.
module check
  use kinds, only: wp
  use mpi_f08, only: MPI_COMM_WORLD, MPI_LOGICAL, MPI_LAND, MPI_Allreduce, MPI_Comm_rank
  implicit none
  private
  public :: expect, expect_all, expect_close, finish

contains

  !> One line: 'ok NAME' or 'FAIL NAME'.
  subroutine expect(ok, name)
    logical, intent(in) :: ok
    character(len=*), intent(in) :: name

    print '(2a)', trim(merge('ok  ', 'FAIL', ok))//' ', name
  end subroutine expect

  !> What must hold on every rank, told once.
  subroutine expect_all(ok, name)
    logical, intent(in) :: ok
    character(len=*), intent(in) :: name

    logical :: everywhere
    integer :: rank

    call MPI_Allreduce(ok, everywhere, 1, MPI_LOGICAL, MPI_LAND, MPI_COMM_WORLD)
    call MPI_Comm_rank(MPI_COMM_WORLD, rank)
    if (rank == 0) call expect(everywhere, name)
  end subroutine expect_all

  !> Whether `value` is within `tolerance` of `expected`, relative unless `expected` is 0.
  subroutine expect_close(value, expected, tolerance, name)
    real(wp), intent(in) :: value, expected, tolerance
    character(len=*), intent(in) :: name

    real(wp) :: scale
    character(len=90) :: figures

    scale = merge(abs(expected), 1.0_wp, abs(expected) > 0.0_wp)
    write (figures, '(2(a,es22.15),a,es8.1)') ' = ', value, ', expected ', expected, ' +- ', tolerance
    call expect(abs(value - expected) <= tolerance*scale, name//trim(figures))
  end subroutine expect_close

  !> The last line of a test program; the runner fails a program that does not reach it.
  subroutine finish()
    print '(a)', 'finished'
  end subroutine finish

end module check
